#include "capture/decode/axcsi_decoder.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "capture/decode/decoder_registry.h"
#include "tests/support/wire_writer.h"

namespace rayloc::axcsi_decoder_test {
namespace {

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

TEST(AxcsiDecoder, GivesAReasonForEachInvalidDatagram) {
  std::vector<std::byte> payload = with_field(0, 0);
  ASSERT_TRUE(AxcsiDecoder().decode(payload));
  payload.pop_back();
  EXPECT_EQ(reason_of(payload), RejectReason::kLengthMismatch);
  payload.resize(53);
  EXPECT_EQ(reason_of(payload), RejectReason::kTooShort);
  EXPECT_EQ(reason_of({}), RejectReason::kTooShort);
  EXPECT_EQ(reason_of(with_field(8, 4)), RejectReason::kRxChainRange);
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
}  // namespace rayloc::axcsi_decoder_test
