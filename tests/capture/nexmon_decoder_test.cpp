#include "capture/decode/nexmon_decoder.h"

#include <gtest/gtest.h>

#include "capture/decode/decoder_registry.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::nexmon_decoder_test {
namespace {

using test::Recording;

TEST(NexmonDecoder, ReadsCoreAndStreamFromTheHighByteOnBcm4366c0) {
  test::WireFrame frame;
  frame.rx_chains = {0, 1, 3};
  frame.streams = 2;
  frame.channel_mhz = frame.occupied_mhz = 80;
  for (const auto chip : {test::NexmonChip::k4366c0, test::NexmonChip::k4358}) {
    const Recording recording = test::write_nexmon(frame, chip, 1, Timestamp());
    const auto last = NexmonDecoder(NexmonVersion::kV1).decode(recording.back().payload);
    ASSERT_TRUE(last);
    EXPECT_EQ(last->rx_chain, 3);
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

TEST(NexmonDecoder, RecognisesAnUnknownChipByItsBitLayout) {
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

TEST(NexmonDecoder, GivesAReasonForEachInvalidDatagram) {
  const auto good = test::write_nexmon({}, test::NexmonChip::k4358, 1, Timestamp()).front().payload;
  const NexmonDecoder decoder(NexmonVersion::kV1);
  EXPECT_EQ(NexmonDecoder(NexmonVersion::kV2).decode(good).error(), RejectReason::kWrongVersion);
  EXPECT_EQ(decoder.decode({good.data(), 17}).error(), RejectReason::kTooShort);
  auto bad = good;
  bad[0] = std::byte{0};
  EXPECT_EQ(decoder.decode(bad).error(), RejectReason::kBadMagic);
  bad = good;
  bad[12] = std::byte{4};
  EXPECT_EQ(decoder.decode(bad).error(), RejectReason::kRxChainRange);
  bad[12] = std::byte{0x20};
  EXPECT_EQ(decoder.decode(bad).error(), RejectReason::kStreamRange);
}

}  // namespace
}  // namespace rayloc::nexmon_decoder_test
