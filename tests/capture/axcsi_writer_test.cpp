// The product's writer of AX-CSI against the decoder, and against the writer of the tests, which
// was written from the tables alone.
#include "capture/decode/axcsi_writer.h"

#include <array>
#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::axcsi_writer_test {
namespace {

using Value = std::complex<double>;

std::complex<float> unpack(std::uint32_t word) {
  std::array<std::byte, kBytesPerWord> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(word >> (8 * i) & 0xffU);
  }
  std::array<std::complex<float>, 1> value;
  unpack_csi_words(CsiWords::kFloat12, bytes, value);
  return value[0];
}

TEST(AxcsiWord, ReadsBackWithinHalfAStepOfElevenBits) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 10'000; ++i) {
    const Value value = std::ldexp(1.0, i % 60 - 20) * Value(uniform(random), uniform(random));
    const Value back(unpack(pack_axcsi_word(value)));
    const double largest = std::max(std::abs(value.real()), std::abs(value.imag()));
    double step = std::ldexp(1.0, std::max(std::ilogb(largest) - 10, -32));
    if (largest >= 2047.5 * step) {
      step *= 2.0;  // rounds up to a twelfth bit
    }
    EXPECT_LE(std::abs(back.real() - value.real()), 0.5 * step) << value;
    EXPECT_LE(std::abs(back.imag() - value.imag()), 0.5 * step) << value;
  }
}

TEST(AxcsiWord, PreservesRepresentableValuesExactly) {
  for (const Value value : {Value(0.0, 0.0),
                            Value(2047.0, -2047.0),
                            Value(-1.0, 1024.0),
                            Value(std::ldexp(2047.0, 31), 0.0),
                            Value(0.0, std::ldexp(1.0, -32))}) {
    EXPECT_EQ(Value(unpack(pack_axcsi_word(value))), value);
  }
}

TEST(AxcsiWord, CarriesIntoTheExponentWhenTheMantissaIsFull) {
  EXPECT_EQ(Value(unpack(pack_axcsi_word({2047.6, 3.0}))), Value(2048.0, 4.0));
}

TEST(AxcsiWord, EqualsTheRecordedOnes) {
  // AllData.pcap, the first datagram (WIRE_FORMATS 1.1).
  EXPECT_EQ(Value(unpack(0x1c2e2a36)) * 65536.0, Value(115392.0, -10752.0));
  for (const std::uint32_t word : {0x1c2e2a36U, 0x169785b7U, 0x393200f7U, 0x2c4f3837U}) {
    const Value recorded(unpack(word));
    EXPECT_EQ(Value(unpack(pack_axcsi_word(recorded))), recorded);
  }
}

AxcsiHeader sample_header() {
  AxcsiHeader header;
  header.transmitter = {{0x02, 0x52, 0x4c, 0xa5, 0x5a, 0xff}};
  header.sequence = 0xfedc;
  header.rx_chain = 2;
  header.stream = 1;
  header.first_tone = 64;
  header.last_tone = 127;
  header.total_tones = 128;
  header.sequence_control = 0x92e1;
  header.ratespec = 0x02c20018;
  header.receive_ticks = 0x123456789abc;
  header.receive_sequence = 0x92e1;
  header.receive_time_us = 0xdeadbeef;
  header.transmit_ticks = 0xcba987654321;
  header.transmit_sequence = 0x7531;
  header.power_dbm = {-43, -54, -48, -1};
  header.phy_status = 0xac43;
  header.chanspec = 0xd99f;
  return header;
}

TEST(AxcsiWriter, WritesEveryFieldThatTheDecoderReads) {
  const AxcsiHeader sent = sample_header();
  const auto bytes = write_axcsi_datagram(sent, std::vector<Value>(64));
  const auto read = read_axcsi_header(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->transmitter, sent.transmitter);
  EXPECT_EQ(read->sequence, sent.sequence);
  EXPECT_EQ(read->rx_chain, sent.rx_chain);
  EXPECT_EQ(read->stream, sent.stream);
  EXPECT_EQ(read->first_tone, sent.first_tone);
  EXPECT_EQ(read->last_tone, sent.last_tone);
  EXPECT_EQ(read->total_tones, sent.total_tones);
  EXPECT_EQ(read->sequence_control, sent.sequence_control);
  EXPECT_EQ(read->ratespec, sent.ratespec);
  EXPECT_EQ(read->receive_ticks, sent.receive_ticks);
  EXPECT_EQ(read->receive_sequence, sent.receive_sequence);
  EXPECT_EQ(read->receive_time_us, sent.receive_time_us);
  EXPECT_EQ(read->transmit_ticks, sent.transmit_ticks);
  EXPECT_EQ(read->transmit_sequence, sent.transmit_sequence);
  EXPECT_EQ(read->power_dbm, sent.power_dbm);
  EXPECT_EQ(read->phy_status, sent.phy_status);
  EXPECT_EQ(read->chanspec, sent.chanspec);
}

struct Layout {
  const char* name;
  test::WirePhy phy;
  int bandwidth_mhz;
};

class AxcsiLayout : public ::testing::TestWithParam<Layout> {};

// Both are given the same tones; what they make of them must be the same bytes.
TEST_P(AxcsiLayout, EqualsTheIndependentWriterByteForByte) {
  test::WireFrame wire;
  wire.phy = GetParam().phy;
  wire.channel_mhz = wire.occupied_mhz = GetParam().bandwidth_mhz;
  wire.rx_chains = {0, 2, 3};
  AxcsiFrame frame;
  frame.header.transmitter = {{0x02, 0x52, 0x4c, 0x00, 0x00, 0x01}};
  frame.header.sequence = wire.sequence;
  frame.header.sequence_control = wire.sequence_control;
  const auto encoding = static_cast<std::uint32_t>(GetParam().phy);
  frame.header.ratespec =
      encoding << 24U | 1U << 16U | (GetParam().phy == test::WirePhy::kHt ? 4U : 0x17U);
  frame.header.power_dbm = {-41, -42, -43, -44};
  frame.header.phy_status = 0x0843;
  frame.header.chanspec = wire.chanspec = 0xd99f;
  for (const int rx_chain : wire.rx_chains) {
    frame.rx_chains.push_back(static_cast<std::uint8_t>(rx_chain));
    const auto tones = test::wire_tones(wire, rx_chain, 0);
    // Back from the order of the wire, as WIRE_FORMATS 1.4 gives it: tone -n/2 is at n/2; 160 MHz
    // in 512 tones has its lower half at 256 to 511, each half in such an order.
    const std::size_t n = tones.size();
    const std::size_t parts = n == 512 && GetParam().phy != test::WirePhy::kHe ? 2 : 1;
    const std::size_t length = n / parts;
    for (std::size_t part = parts; part-- > 0;) {
      for (std::size_t i = 0; i < length; ++i) {
        frame.tones.push_back(tones[part * length + (i + length / 2) % length]);
      }
    }
  }
  const auto ours = write_axcsi_frame(frame);
  const auto theirs = test::write_axcsi(wire, Timestamp{});
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i], theirs[i].payload) << "datagram " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats,
                         AxcsiLayout,
                         ::testing::Values(Layout{"Vht20", test::WirePhy::kVht, 20},
                                           Layout{"Vht40", test::WirePhy::kVht, 40},
                                           Layout{"Ht40", test::WirePhy::kHt, 40},
                                           Layout{"Vht80", test::WirePhy::kVht, 80},
                                           Layout{"Vht160", test::WirePhy::kVht, 160},
                                           Layout{"He20", test::WirePhy::kHe, 20},
                                           Layout{"He40", test::WirePhy::kHe, 40},
                                           Layout{"He160", test::WirePhy::kHe, 160}),
                         [](const auto& layout) { return std::string(layout.param.name); });

}  // namespace
}  // namespace rayloc::axcsi_writer_test
