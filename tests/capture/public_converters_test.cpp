// The decoders on other people's recordings, against what the extractors' own converters make of
// them.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "capture/decode/axcsi_decoder.h"
#include "capture/decode/decoder_registry.h"
#include "tests/support/mat_file.h"
#include "tests/support/public_captures.h"

namespace rayloc::public_converters_test {
namespace {

using test::PublicCaptures;
using test::Recording;

// One row of the published converter's text output.
struct ConverterRow {
  std::array<std::string, 27> header;  // as text: exact whatever the type
  std::vector<std::complex<double>> csi;
};

std::vector<ConverterRow> read_converter_output() {
  const auto bytes = test::read_bytes(test::public_capture("axcsi-rt-ax86u/data.mat.txt"));
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

// The converter's 27 columns of header (WIRE_FORMATS 1.5).
std::array<std::string, 27> columns_of(const AxcsiHeader& header, Timestamp time) {
  constexpr std::uint64_t kTicksModulus = std::uint64_t{1} << 48U;
  const auto microseconds =
      std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
  std::string fraction = std::to_string(microseconds % 1'000'000);
  fraction.insert(0, 6 - fraction.size(), '0');
  std::array<std::string, 27> columns = {std::to_string(header.sequence),
                                         std::to_string(header.rx_chain),
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
  for (std::size_t rx_chain = 0; rx_chain < 4; ++rx_chain) {
    columns[18 + rx_chain] = std::to_string(static_cast<std::uint8_t>(header.power_dbm[rx_chain]));
  }
  columns[22] = std::to_string(header.phy_status);
  columns[23] = std::to_string((header.ratespec >> 16U) & 0xffU);
  columns[24] = std::to_string(header.streams());
  columns[25] = std::to_string(header.mcs());
  columns[26] = std::to_string(header.chanspec);
  return columns;
}

TEST_F(PublicCaptures, AxcsiEqualsThePublishedConverterInEveryValueAndColumn) {
  const Recording recording = test::read_public_capture("axcsi-rt-ax86u/AllData.pcap");
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

TEST_F(PublicCaptures, FirstHeaderOfAllData) {
  const Recording recording = test::read_public_capture("axcsi-rt-ax86u/AllData.pcap");
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

std::vector<std::complex<float>> decode_csi(const std::vector<std::byte>& payload) {
  const DecodeResult fragment = DecoderRegistry("").decode(payload);
  EXPECT_TRUE(fragment);
  std::vector<std::complex<float>> csi(fragment->tones);
  unpack_csi_words(fragment->layout, fragment->words, csi);
  return csi;
}

// Values of one datagram that differ from the truncated `expected`, at a scale of 2^shift.
int differences(const std::vector<std::complex<float>>& csi,
                const std::complex<int>* expected,
                int shift) {
  int count = 0;
  for (std::size_t k = 0; k < csi.size(); ++k) {
    count += std::trunc(std::ldexp(csi[k].real(), shift)) != static_cast<float>(expected[k].real());
    count += std::trunc(std::ldexp(csi[k].imag(), shift)) != static_cast<float>(expected[k].imag());
  }
  return count;
}

// nexmon's reader scales each datagram by its own power of two, which it does not report, and
// truncates: there must be one scale at which all values agree exactly.
void expect_equal_up_to_scale(const std::string& name) {
  const Recording recording = test::read_public_capture("nexmon-csikit/" + name + ".pcap");
  const auto expected =
      test::read_mat_file(test::public_capture("nexmon-csikit/" + name + ".mat")).values;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const auto csi = decode_csi(recording[i].payload);
    ASSERT_LE((i + 1) * csi.size(), expected.size());
    int fewest = static_cast<int>(2 * csi.size());
    for (int shift = -40; shift <= 40; ++shift) {
      fewest = std::min(fewest, differences(csi, expected.data() + i * csi.size(), shift));
    }
    EXPECT_EQ(fewest, 0) << name << " datagram " << i;
    compared += csi.size();
  }
  EXPECT_EQ(compared, expected.size());
}

TEST_F(PublicCaptures, NexmonEqualsTheMatFileOfBcm4366c0) {
  expect_equal_up_to_scale("example_4366c0");
}

TEST_F(PublicCaptures, NexmonEqualsTheMatFileOfBcm4358) {
  expect_equal_up_to_scale("example_4358");
}

TEST_F(PublicCaptures, NexmonEqualsTheMatFileOfBcm43455c0) {
  const std::string name = "nexmon-csikit/example_43455c0";
  const Recording recording = test::read_public_capture(name + ".pcap");
  const auto expected = test::read_mat_file(test::public_capture(name + ".mat"));
  // The converter left out the 119th datagram and some after it.
  constexpr std::size_t kInStep = 118;
  ASSERT_LE(kInStep, expected.rows);
  for (std::size_t i = 0; i < kInStep; ++i) {
    EXPECT_EQ(
        differences(
            decode_csi(recording[i].payload), expected.values.data() + i * expected.columns, 0),
        0)
        << i;
  }
}

TEST_F(PublicCaptures, UbilocateIsReadAsTheFirmwareWritesIt) {
  const auto recording = test::read_public_capture("ubilocate-rt-ac86u/test_ch_bw_trace4.pcap");
  const auto fragment = DecoderRegistry("").decode(recording[7].payload);
  ASSERT_TRUE(fragment);
  EXPECT_EQ(fragment->format, "ubilocate");
  EXPECT_EQ(to_string(fragment->transmitter), "00:12:34:56:78:9b");
  EXPECT_EQ(fragment->rx_chain, 1);
  EXPECT_EQ(fragment->stream, 3);
  EXPECT_EQ(fragment->sequence, 100);
  EXPECT_EQ(fragment->expected_slots, 0xffff);
  EXPECT_EQ(fragment->transmitted_streams, 4);
  EXPECT_EQ(fragment->total_tones, 128);
  // Only the first datagram of a frame has the trailer with the power.
  EXPECT_FALSE(fragment->power_dbm[0]);
  EXPECT_EQ(DecoderRegistry("").decode(recording[0].payload)->power_dbm[2], -45);
}

}  // namespace
}  // namespace rayloc::public_converters_test
