#include "capture/axcsi_decoder.h"

#include <array>
#include <cmath>
#include <complex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "capture/decoder_registry.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc {
namespace {

using test::RecordedDatagram;
using test::Recording;

// One row of the published converter's text output.
struct ConverterRow {
  std::array<std::string, 27> header;  // as text: exact whatever the type
  std::vector<std::complex<double>> csi;
};

std::vector<ConverterRow> read_converter_output() {
  const auto bytes = test::read_file(RAYLOC_TEST_DATA "/captures/axcsi-rt-ax86u/data.mat.txt");
  std::istringstream text(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  std::vector<ConverterRow> rows;
  for (std::string line; std::getline(text, line);) {
    std::istringstream columns(line);
    ConverterRow row;
    for (std::string& column : row.header) {
      columns >> column;
    }
    for (double i = 0, q = 0; columns >> i >> q;) {
      row.csi.emplace_back(i, q);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

// The converter's 27 columns of header ([AXCSI 1.5]).
std::array<std::string, 27> columns_of(const AxcsiHeader& header, Timestamp time) {
  constexpr std::uint64_t kTicksModulus = std::uint64_t{1} << 48U;
  const auto microseconds =
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
  std::string fraction = std::to_string(microseconds % 1'000'000);
  fraction.insert(0, 6 - fraction.size(), '0');
  std::array<std::string, 27> columns = {std::to_string(header.sequence),
                                         std::to_string(header.core),
                                         std::to_string(header.stream),
                                         "0",
                                         std::to_string(header.last_tone),
                                         std::to_string(header.encoding())};
  for (std::size_t i = 0; i < 6; ++i) {
    columns[6 + i] = std::to_string(header.transmitter.octets[i]);
  }
  columns[12] = std::to_string(microseconds / 1'000'000) + "." + fraction;
  columns[13] = std::to_string(kTicksModulus - header.receive_ticks);
  columns[14] = std::to_string(header.receive_time_us);
  columns[15] = std::to_string(header.receive_sequence);
  columns[16] = std::to_string(kTicksModulus - header.transmit_ticks);
  columns[17] = std::to_string(header.transmit_sequence);
  for (std::size_t core = 0; core < 4; ++core) {
    columns[18 + core] = std::to_string(static_cast<std::uint8_t>(header.power_dbm[core]));
  }
  columns[22] = std::to_string(header.phy_status);
  columns[23] = std::to_string((header.ratespec >> 16U) & 0xffU);
  columns[24] = std::to_string(header.streams());
  columns[25] = std::to_string(header.mcs());
  columns[26] = std::to_string(header.chanspec);
  return columns;
}

TEST(AxcsiDecoder, EqualsThePublishedConverterInEveryValueAndColumn) {
  const Recording recording = test::read_capture("axcsi-rt-ax86u/AllData.pcap");
  const std::vector<ConverterRow> rows = read_converter_output();
  ASSERT_EQ(recording.size(), 144U);
  ASSERT_EQ(rows.size(), 144U);
  std::size_t values = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto header = read_axcsi_header(recording[i].payload);
    ASSERT_TRUE(header);
    EXPECT_EQ(columns_of(*header, recording[i].time), rows[i].header) << "row " << i;

    const auto fragment = AxcsiDecoder().decode(recording[i].payload);
    ASSERT_TRUE(fragment);
    std::vector<std::complex<float>> csi(fragment->tones);
    unpack_csi_words(fragment->layout, fragment->words, csi);
    ASSERT_EQ(rows[i].csi.size(), csi.size());
    for (std::size_t k = 0; k < csi.size(); ++k) {
      // Ascending tones there, the order of the wire here; 2^16 times the value, truncated.
      const std::complex<float> value = csi[(k + csi.size() / 2) % csi.size()];
      EXPECT_EQ(std::trunc(std::ldexp(value.real(), 16)), rows[i].csi[k].real());
      EXPECT_EQ(std::trunc(std::ldexp(value.imag(), 16)), rows[i].csi[k].imag());
      ++values;
    }
  }
  EXPECT_EQ(values, 18'432U);
}

TEST(AxcsiDecoder, ReadsTheFirstHeaderOfAllData) {
  const Recording recording = test::read_capture("axcsi-rt-ax86u/AllData.pcap");
  const auto header = read_axcsi_header(recording[0].payload);
  ASSERT_TRUE(header);
  EXPECT_EQ(to_string(header->transmitter), "90:78:b2:b8:36:d5");
  EXPECT_EQ(header->sequence, 543);
  EXPECT_EQ(header->sequence_control, 0x92e0);
  EXPECT_EQ(header->ratespec, 0x02c20018U);
  EXPECT_EQ(header->rate_bandwidth(), 2U);
  EXPECT_EQ(header->streams(), 1U);
  EXPECT_EQ(header->mcs(), 8U);
  EXPECT_EQ(header->power_dbm, (std::array<std::int8_t, 4>{-43, -54, -48, -48}));
  EXPECT_EQ(header->chanspec, 0xd99f);
}

// A good datagram whose two bytes at `offset` are replaced.
std::vector<std::byte> with_field(std::size_t offset, std::uint16_t value) {
  std::vector<std::byte> payload = test::write_axcsi({}, Timestamp()).front().payload;
  payload[offset] = static_cast<std::byte>(value & 0xffU);
  payload[offset + 1] = static_cast<std::byte>(value >> 8U);
  return payload;
}

RejectReason reason_of(const std::vector<std::byte>& payload) {
  const DecodeResult result = AxcsiDecoder().decode(payload);
  EXPECT_FALSE(result);
  return result ? RejectReason::kUnknownFormat : result.error();
}

TEST(AxcsiDecoder, NamesWhatIsWrong) {
  std::vector<std::byte> payload = with_field(0, 0);
  ASSERT_TRUE(AxcsiDecoder().decode(payload));
  payload.pop_back();
  EXPECT_EQ(reason_of(payload), RejectReason::kLengthMismatch);
  payload.resize(53);
  EXPECT_EQ(reason_of(payload), RejectReason::kTooShort);
  EXPECT_EQ(reason_of({}), RejectReason::kTooShort);
  EXPECT_EQ(reason_of(with_field(8, 4)), RejectReason::kCoreRange);
  EXPECT_EQ(reason_of(with_field(10, 4)), RejectReason::kStreamRange);
  EXPECT_EQ(reason_of(with_field(12, 200)), RejectReason::kLengthMismatch);  // first > last
  EXPECT_EQ(reason_of(with_field(14, 126)), RejectReason::kLengthMismatch);  // one tone less
  EXPECT_EQ(reason_of(with_field(16, 100)), RejectReason::kToneRange);
  EXPECT_EQ(reason_of(with_field(16, 1024)), RejectReason::kToneRange);  // no VHT has that many
  EXPECT_EQ(reason_of(with_field(16, 0)), RejectReason::kToneRange);
  EXPECT_EQ(reason_of(with_field(22, 0x0401)), RejectReason::kEncodingRange);
  EXPECT_EQ(reason_of(with_field(18, 0x20)), RejectReason::kHeaderMismatch);
}

TEST(AxcsiDecoder, AnyTruncationIsRefused) {
  const std::vector<std::byte> whole = with_field(0, 0);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::vector<std::byte> cut(whole.begin(),
                                     whole.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_FALSE(AxcsiDecoder().decode(cut)) << length;
    EXPECT_FALSE(DecoderRegistry("").decode(cut)) << length;
  }
}

}  // namespace
}  // namespace rayloc
