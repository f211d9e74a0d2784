#include "capture/nexmon_decoder.h"

#include <cmath>
#include <complex>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "capture/decoder_registry.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc {
namespace {

using test::Recording;

// What convert_mat.py wrote: rows of `tones` values.
std::vector<std::complex<int>> read_values(const std::string& name) {
  const auto bytes = test::read_file(std::string(RAYLOC_TEST_DATA) + "/captures/nexmon-csikit/" +
                                     name + ".values.gz");
  std::vector<std::int16_t> parts(bytes.size() / sizeof(std::int16_t));
  std::memcpy(parts.data(), bytes.data(), parts.size() * sizeof(std::int16_t));
  std::vector<std::complex<int>> values;
  for (std::size_t i = 0; i < parts.size(); i += 2) {
    values.emplace_back(parts[i], parts[i + 1]);
  }
  return values;
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

// nexmon's reader scales each datagram by its own power of two, which it does not tell, and
// truncates: there must be one scale at which all values agree exactly.
void expect_equal_up_to_scale(const std::string& name, const std::string& capture) {
  const Recording recording = test::read_capture("nexmon-csikit/" + capture);
  const auto expected = read_values(name);
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

TEST(NexmonDecoder, EqualsTheMatFileOfBcm4366c0) {
  expect_equal_up_to_scale("example_4366c0", "example_4366c0.pcap.gz");
}

TEST(NexmonDecoder, EqualsTheMatFileOfBcm4358) {
  expect_equal_up_to_scale("example_4358", "example_4358.pcap");
}

TEST(NexmonDecoder, EqualsTheMatFileOfBcm43455c0) {
  const Recording recording = test::read_capture("nexmon-csikit/example_43455c0.pcap.gz");
  const auto expected = read_values("example_43455c0");
  ASSERT_EQ(expected.size(), 40U * 256U);
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(differences(decode_csi(recording[i].payload), expected.data() + i * 256, 0), 0) << i;
  }
}

TEST(NexmonDecoder, ReadsCoreAndStreamFromTheHighByteOnBcm4366c0) {
  test::WireFrame frame;
  frame.cores = {0, 1, 3};
  frame.streams = 2;
  frame.channel_mhz = frame.occupied_mhz = 80;
  for (const auto chip : {test::NexmonChip::k4366c0, test::NexmonChip::k4358}) {
    const Recording recording = test::write_nexmon(frame, chip, 1, Timestamp());
    const auto last = NexmonDecoder(NexmonVersion::kV1).decode(recording.back().payload);
    ASSERT_TRUE(last);
    EXPECT_EQ(last->core, 3);
    EXPECT_EQ(last->stream, 1);
  }
}

TEST(NexmonDecoder, Version2HasRssiAndOverwrittenWords) {
  test::WireFrame frame;
  frame.channel_mhz = frame.occupied_mhz = 20;
  const Recording recording = test::write_nexmon(frame, test::NexmonChip::k43455c0, 2, Timestamp());
  const auto fragment = DecoderRegistry("").decode(recording[0].payload);
  ASSERT_TRUE(fragment);
  EXPECT_EQ(fragment->format, "nexmon-v2");
  EXPECT_EQ(fragment->power_dbm[0], -41);
  EXPECT_EQ(fragment->overwritten_first, 28);
  EXPECT_EQ(fragment->overwritten_count, 3);
}

TEST(NexmonDecoder, UnknownChipIsToldByTheBitsItUses) {
  test::WireFrame frame;
  const struct {
    test::NexmonChip chip;
    CsiWords layout;
  } cases[] = {{test::NexmonChip::k4366c0, CsiWords::kFloat12},
               {test::NexmonChip::k4358, CsiWords::kFloat9},
               {test::NexmonChip::k43455c0, CsiWords::kInt16}};
  for (const auto& c : cases) {
    auto payload = test::write_nexmon(frame, c.chip, 1, Timestamp()).front().payload;
    payload[16] = std::byte{0x34};  // 0xe834, seen of an old build
    payload[17] = std::byte{0xe8};
    const auto fragment = DecoderRegistry("").decode(payload);
    ASSERT_TRUE(fragment);
    EXPECT_EQ(fragment->layout, c.layout);
  }
}

TEST(NexmonDecoder, FourTrailingBytesAreAllowedFiveAreNot) {
  auto payload = test::write_nexmon({}, test::NexmonChip::k4358, 1, Timestamp()).front().payload;
  payload.resize(payload.size() + 4);
  const auto fragment = NexmonDecoder(NexmonVersion::kV1).decode(payload);
  ASSERT_TRUE(fragment);
  EXPECT_EQ(fragment->words.size(), 4U * 128U);
  payload.resize(payload.size() + 1);
  EXPECT_EQ(NexmonDecoder(NexmonVersion::kV1).decode(payload).error(),
            RejectReason::kLengthMismatch);
}

TEST(NexmonDecoder, NamesWhatIsWrong) {
  const auto good = test::write_nexmon({}, test::NexmonChip::k4358, 1, Timestamp()).front().payload;
  const NexmonDecoder decoder(NexmonVersion::kV1);
  EXPECT_EQ(NexmonDecoder(NexmonVersion::kV2).decode(good).error(), RejectReason::kWrongVersion);
  EXPECT_EQ(decoder.decode({good.data(), 17}).error(), RejectReason::kTooShort);
  auto bad = good;
  bad[0] = std::byte{0};
  EXPECT_EQ(decoder.decode(bad).error(), RejectReason::kBadMagic);
  bad = good;
  bad[12] = std::byte{4};
  EXPECT_EQ(decoder.decode(bad).error(), RejectReason::kCoreRange);
  bad[12] = std::byte{0x20};
  EXPECT_EQ(decoder.decode(bad).error(), RejectReason::kStreamRange);
}

}  // namespace
}  // namespace rayloc
