// A chip whose datagram carries a whole frame: one row, and the frame passes the assembler by.
#include "capture/decode/frame_decoder.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/csi_receiver.h"
#include "capture/decode/decoder_registry.h"
#include "capture/transport/byte_reader.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::frame_decoder_test {
namespace {

using test::Recording;
using ::testing::ElementsAre;
using ::testing::Pair;

constexpr Timestamp kStart{std::chrono::seconds(1'000)};

// A format that exists in this file only:
//   0  4  "WHOL"    4  1  receive chains    5  1  tones    6  a byte a chain and tone, the real
//   part
constexpr std::size_t kHeader = 6;

bool resembles_whole(std::span<const std::byte> payload) {
  return payload.size() >= 4 && ByteReader(payload).u32(0) == 0x4c4f4857;
}

class WholeDecoder final : public FrameDecoder {
 public:
  std::string_view format() const override { return "whole"; }
  FrameResult decode(std::span<const std::byte> payload) const override {
    if (payload.size() < kHeader) {
      return tl::make_unexpected(RejectReason::kTooShort);
    }
    if (!resembles_whole(payload)) {
      return tl::make_unexpected(RejectReason::kBadMagic);
    }
    const ByteReader reader(payload);
    const std::size_t rx_chains = reader.u8(4);
    const std::size_t tones = reader.u8(5);
    if (payload.size() != kHeader + rx_chains * tones) {
      return tl::make_unexpected(RejectReason::kLengthMismatch);
    }
    CsiFrame frame;
    frame.format = format();
    frame.csi = Csi(rx_chains, 1, tones);
    frame.power_dbm.resize(rx_chains);
    for (std::size_t rx_chain = 0; rx_chain < rx_chains; ++rx_chain) {
      frame.rx_chains.push_back(static_cast<std::uint8_t>(rx_chain));
      for (std::size_t tone = 0; tone < tones; ++tone) {
        frame.csi.row(rx_chain, 0)[tone] = reader.u8(kHeader + rx_chain * tones + tone);
      }
    }
    for (std::size_t tone = 0; tone < tones; ++tone) {
      frame.tone_index.push_back(static_cast<std::int16_t>(tone));
    }
    frame.complete = true;
    return frame;
  }
};

// The one row, before those there are.
std::vector<DecoderRow> with_whole() {
  std::vector<DecoderRow> rows{
      {.name = "whole", .resembles = resembles_whole, .make = []() -> AnyDecoder {
         return std::make_unique<WholeDecoder>();
       }}};
  rows.insert(rows.end(), decoder_rows().begin(), decoder_rows().end());
  return rows;
}

test::RecordedDatagram whole_datagram(std::vector<unsigned char> bytes, Duration after) {
  test::RecordedDatagram datagram{kStart + after, {}};
  for (const char c : std::string("WHOL")) {
    datagram.payload.push_back(static_cast<std::byte>(c));
  }
  for (const unsigned char byte : bytes) {
    datagram.payload.push_back(static_cast<std::byte>(byte));
  }
  return datagram;
}

CsiReceiverOptions of_format(const std::string& format) {
  CsiReceiverOptions options;
  options.format = format;
  return options;
}

TEST(FrameDecoder, AWholeFrameIsGivenAtOnce) {
  const std::vector<DecoderRow> rows = with_whole();
  CsiReceiverOptions options;
  options.access_point = 3;
  CsiReceiver receiver(options, rows);
  std::vector<CsiFrame> frames;
  const auto datagram = whole_datagram({2, 3, 1, 2, 3, 4, 5, 6}, {});
  receiver.push(datagram.view(), frames);
  ASSERT_EQ(frames.size(), 1U);
  const CsiFrame& frame = frames.front();
  EXPECT_EQ(frame.time, kStart);
  EXPECT_EQ(frame.time_last, kStart);
  EXPECT_EQ(frame.access_point, 3);
  EXPECT_EQ(frame.format, "whole");
  EXPECT_TRUE(frame.complete);
  EXPECT_EQ(frame.csi.row(1, 0)[2], std::complex<float>(6));
  EXPECT_EQ(receiver.safe_time(kStart), kStart) << "nothing is being assembled";
  const CsiReceiverCounters counters = receiver.counters();
  EXPECT_EQ(counters.in_frames, 1U);
  EXPECT_EQ(counters.in_flight, 0U);
  EXPECT_EQ(counters.partial, 0U);
  test::expect_conservation(counters);
}

TEST(FrameDecoder, FramesInPiecesComeBesideIt) {
  const std::vector<DecoderRow> rows = with_whole();
  Recording recording = test::write_axcsi({}, kStart);
  recording.push_back(whole_datagram({1, 1, 9}, std::chrono::milliseconds(1)));
  recording.push_back(whole_datagram({1, 2, 9}, std::chrono::milliseconds(2)));  // too short
  CsiReceiver receiver({}, rows);
  std::vector<std::string_view> formats;
  for (const CsiFrame& frame : test::receive_all(receiver, recording)) {
    formats.push_back(frame.format);
  }
  EXPECT_THAT(formats, ::testing::UnorderedElementsAre("axcsi-v4", "whole"));
  EXPECT_THAT(receiver.counters().rejected, ElementsAre(Pair("length_mismatch", 1)));
}

TEST(FrameDecoder, FlagsAMissingExpectedRxChain) {
  const std::vector<DecoderRow> rows = with_whole();
  CsiReceiverOptions options;
  options.expected_rx_chains = {0, 1};
  CsiReceiver receiver(options, rows);
  std::vector<CsiFrame> frames;
  const auto datagram = whole_datagram({1, 1, 9}, {});
  receiver.push(datagram.view(), frames);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_FALSE(frames.front().complete);
  EXPECT_THAT(frames.front().flags, ElementsAre("missing_core"));
  EXPECT_EQ(receiver.counters().partial, 1U);
}

TEST(FrameDecoder, AFixedFormatRejectsOtherFormats) {
  const std::vector<DecoderRow> rows = with_whole();
  CsiReceiver whole(of_format("whole"), rows);
  const Recording recording = test::write_axcsi({}, kStart);
  EXPECT_TRUE(test::receive_all(whole, recording).empty());
  EXPECT_THAT(whole.counters().rejected, ElementsAre(Pair("bad_magic", recording.size())));
  CsiReceiver axcsi(of_format("axcsi-v4"), rows);
  EXPECT_TRUE(test::receive_all(axcsi, {whole_datagram({1, 1, 9}, {})}).empty());
  EXPECT_THAT(axcsi.counters().rejected, ElementsAre(Pair("too_short", 1)));
}

TEST(DecoderRegistry, EveryRowIsNamedAsItsDecoder) {
  for (const DecoderRow& row : decoder_rows()) {
    const AnyDecoder decoder = row.make();
    std::visit([&](const auto& one) { EXPECT_EQ(one->format(), row.name); }, decoder);
    EXPECT_FALSE(row.resembles({})) << row.name;
  }
}

}  // namespace
}  // namespace rayloc::frame_decoder_test
