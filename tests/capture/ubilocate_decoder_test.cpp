#include "capture/decode/ubilocate_decoder.h"

#include <vector>

#include <gtest/gtest.h>

#include "capture/decode/decoder_registry.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::ubilocate_decoder_test {
namespace {

std::vector<std::byte> good() { return test::write_ubilocate({}, Timestamp())[1].payload; }

RejectReason reason_of(std::vector<std::byte> payload, std::size_t offset, unsigned value) {
  payload[offset] = static_cast<std::byte>(value);
  const DecodeResult result = UbilocateDecoder().decode(payload);
  EXPECT_FALSE(result);
  return result ? RejectReason::kUnknownFormat : result.error();
}

TEST(UbilocateDecoder, GivesAReasonForEachInvalidDatagram) {
  EXPECT_EQ(reason_of(good(), 0, 0x10), RejectReason::kBadMagic);
  EXPECT_EQ(reason_of(good(), 12, 16), RejectReason::kRxChainRange);
  EXPECT_EQ(reason_of(good(), 12, 2), RejectReason::kHeaderMismatch);  // a stream not extracted
  EXPECT_EQ(reason_of(good(), 2, 0x1f), RejectReason::kHeaderMismatch);
  EXPECT_EQ(reason_of(good(), 3, 0), RejectReason::kHeaderMismatch);
  auto payload = good();
  payload.pop_back();
  EXPECT_EQ(UbilocateDecoder().decode(payload).error(), RejectReason::kLengthMismatch);
  payload.resize(17);
  EXPECT_EQ(UbilocateDecoder().decode(payload).error(), RejectReason::kTooShort);
}

TEST(DecoderRegistry, RecognisesEveryFormat) {
  using test::NexmonChip;
  const DecoderRegistry registry("");
  const struct {
    test::Recording recording;
    const char* format;
  } cases[] = {{test::write_axcsi({}, {}), "axcsi-v4"},
               {test::write_nexmon({}, NexmonChip::k4358, 1, {}), "nexmon-v1"},
               {test::write_nexmon({}, NexmonChip::k4358, 2, {}), "nexmon-v2"},
               {test::write_ubilocate({}, {}), "ubilocate"}};
  for (const auto& c : cases) {
    for (const auto& datagram : c.recording) {
      const auto fragment = registry.decode(datagram.payload);
      ASSERT_TRUE(fragment) << c.format;
      EXPECT_EQ(fragment->format, c.format);
      for (const std::string_view other : wire_formats()) {
        EXPECT_EQ(DecoderRegistry(other).decode(datagram.payload).has_value(), other == c.format);
      }
    }
  }
}

TEST(DecoderRegistry, AnAddressThatBeginsLikeTheMagicNumberIsNoMagicNumber) {
  test::WireFrame frame;
  frame.transmitter = 0x11111111aabb;
  const auto fragment = DecoderRegistry("").decode(test::write_axcsi(frame, {})[0].payload);
  ASSERT_TRUE(fragment);
  EXPECT_EQ(fragment->format, "axcsi-v4");
}

TEST(DecoderRegistry, DistinguishesDamagedDatagramsFromUnknownFormats) {
  auto payload = test::write_axcsi({}, {})[0].payload;
  payload.resize(200);
  EXPECT_EQ(DecoderRegistry("").decode(payload).error(), RejectReason::kLengthMismatch);
  const std::vector<std::byte> other(300, std::byte{0x5a});
  EXPECT_EQ(DecoderRegistry("").decode(other).error(), RejectReason::kUnknownFormat);
  EXPECT_EQ(DecoderRegistry("").decode({}).error(), RejectReason::kTooShort);
}

TEST(DecoderRegistry, RecognisesItsFormatNames) {
  EXPECT_EQ(wire_formats().size(), 5U);
  EXPECT_TRUE(is_wire_format("axcsi-v4"));
  EXPECT_FALSE(is_wire_format("axcsi"));
  EXPECT_FALSE(is_wire_format(""));
}

}  // namespace
}  // namespace rayloc::ubilocate_decoder_test
