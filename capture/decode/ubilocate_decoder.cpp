// Layout of the UDP payload, little-endian (WIRE_FORMATS 1.7):
//
//   offset size  field
//    0     2     0x1111
//    2     1     mask of the cores that are extracted
//    3     1     mask of the spatial streams that are extracted
//    4     6     transmitter address, network order
//   10     2     802.11 sequence control
//   12     1     core * 4 + stream
//   14     2     chanspec
//   16     2     frame counter
//   18     4n    CSI words (csi_words.h, kFloat12), n = 64, 128, 256
//   18+4n  128   trailer; in the first datagram of a frame it begins with 0x0827deaf and holds the
//                power of cores 0..3 [dBm], signed, at 7..10 (inferred from recordings); in the
//                others it is memory of the firmware
#include "capture/decode/ubilocate_decoder.h"

#include "capture/decode/broadcom_header.h"
#include "capture/decode/decoder_row.h"
#include "capture/decode/payload_digest.h"

namespace rayloc {
namespace {

constexpr std::size_t kTrailerBytes = 128;
constexpr std::uint32_t kTrailerMagic = 0x0827deaf;
constexpr std::size_t kTrailerPowerOffset = 7;

// The slots of a frame of these cores and streams, and the number of streams.
struct Expectation {
  std::uint16_t slots = 0;
  int streams = 0;
};

Expectation expectation_of(unsigned core_mask, unsigned stream_mask) {
  Expectation expectation;
  for (std::size_t stream = 0; stream < kMaxStreams; ++stream) {
    if (((stream_mask >> stream) & 1U) == 0) {
      continue;
    }
    ++expectation.streams;
    for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
      if (((core_mask >> rx_chain) & 1U) != 0) {
        expectation.slots =
            static_cast<std::uint16_t>(expectation.slots | (1U << slot_of(rx_chain, stream)));
      }
    }
  }
  return expectation;
}

}  // namespace

bool resembles_ubilocate(std::span<const std::byte> payload) {
  return has_nexmon_magic(payload) && nexmon_tones(payload.size(), kTrailerBytes) != 0;
}

DecodeResult UbilocateDecoder::decode(std::span<const std::byte> payload) const {
  if (payload.size() < kNexmonHeaderBytes) {
    return tl::make_unexpected(RejectReason::kTooShort);
  }
  const std::size_t tones = nexmon_tones(payload.size(), kTrailerBytes);
  if (tones == 0) {
    return tl::make_unexpected(RejectReason::kLengthMismatch);
  }
  if (!has_nexmon_magic(payload)) {
    return tl::make_unexpected(RejectReason::kBadMagic);
  }
  const ByteReader reader(payload);
  const unsigned slot = reader.u8(12);
  if (slot >= kMaxSlots) {
    return tl::make_unexpected(RejectReason::kRxChainRange);
  }
  const unsigned core_mask = reader.u8(2);
  const unsigned stream_mask = reader.u8(3);
  const Expectation expectation = expectation_of(core_mask, stream_mask);
  if (core_mask >> kMaxRxChains != 0 || stream_mask >> kMaxStreams != 0 ||
      ((unsigned{expectation.slots} >> slot) & 1U) == 0) {
    return tl::make_unexpected(RejectReason::kHeaderMismatch);
  }
  CsiFragment fragment;
  fragment.format = format();
  fragment.transmitter = nexmon_transmitter(reader);
  fragment.has_sequence = true;
  fragment.sequence = reader.u16(16);
  fragment.sequence_control = reader.u16(10);
  fragment.rx_chain = static_cast<std::uint8_t>(slot / kMaxStreams);
  fragment.stream = static_cast<std::uint8_t>(slot % kMaxStreams);
  fragment.tones = static_cast<std::uint16_t>(tones);
  fragment.total_tones = fragment.tones;
  fragment.channel_bandwidth_mhz = nexmon_bandwidth_mhz(tones);
  fragment.transmitted_streams = expectation.streams;
  fragment.expected_slots = expectation.slots;
  fragment.words = reader.bytes(kNexmonHeaderBytes, kBytesPerWord * tones);
  fragment.layout = CsiWords::kFloat12;
  fragment.digest = payload_digest(fragment.words);
  fragment.channel = nexmon_channel(payload);
  const std::size_t trailer = kNexmonHeaderBytes + kBytesPerWord * tones;
  if (reader.u32(trailer) == kTrailerMagic) {
    for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
      fragment.power_dbm[rx_chain] = reader.i8(trailer + kTrailerPowerOffset + rx_chain);
    }
  }
  return fragment;
}

const DecoderRow kUbilocateRow{
    .name = "ubilocate", .resembles = resembles_ubilocate, .make = []() -> AnyDecoder {
      return std::make_unique<UbilocateDecoder>();
    }};

}  // namespace rayloc
