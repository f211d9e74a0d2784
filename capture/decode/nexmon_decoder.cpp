// Layout of the UDP payload, little-endian (WIRE_FORMATS 1.6):
//
//   offset size  field
//    0     2     0x1111
//    2     1     v1: 0x11    v2: RSSI of the frame [dBm], signed
//    3     1     v1: 0x11    v2: first byte of the 802.11 frame control, 0 on bcm4366c0
//    4     6     transmitter address, network order
//   10     2     802.11 sequence control
//   12     2     csiconf: bits 0-2 core, bits 3-5 stream; on bcm4366c0 in the high byte
//   14     2     chanspec
//   16     2     chip: 0x0001 bcm4339, 0x0065 bcm43455c0, 0x0003 or 0xdead bcm4358,
//                      0x006a bcm4366c0; old builds write junk
//   18     4n    CSI words, n = 64, 128, 256; v2: PhyRxStatus lies over words 0-2, or 28-30 of 64
//   18+4n  0, 4  bytes without meaning
#include "capture/decode/nexmon_decoder.h"

#include "capture/decode/broadcom_header.h"
#include "capture/decode/decoder_row.h"
#include "capture/decode/payload_digest.h"

namespace rayloc {
namespace {

constexpr std::size_t kTrailingBytes = 4;

std::size_t tones_of(std::span<const std::byte> payload) {
  const std::size_t tones = nexmon_tones(payload.size(), 0);
  return tones != 0 ? tones : nexmon_tones(payload.size(), kTrailingBytes);
}

// Old builds write arbitrary values into the chip field; the bits used by the words indicate the
// layout. Real float words keep their top bits clear, int16 words do not (half of all small parts
// are negative), and some normalised 12-bit mantissa extends above bit 22.
CsiWords layout_by_used_bits(std::span<const std::byte> words) {
  const ByteReader reader(words);
  std::uint32_t used = 0;
  for (std::size_t i = 0; i < words.size(); i += kBytesPerWord) {
    used |= reader.u32(i);
  }
  if ((used >> 30U) != 0) {
    return CsiWords::kInt16;
  }
  return (used >> 23U) != 0 ? CsiWords::kFloat12 : CsiWords::kFloat9;
}

CsiWords layout_of(std::uint16_t chip, std::span<const std::byte> words) {
  switch (chip) {
    case 0x0001:
    case 0x0065:
      return CsiWords::kInt16;
    case 0x0003:
    case 0xdead:
      return CsiWords::kFloat9;
    case 0x006a:
      return CsiWords::kFloat12;
    default:
      return layout_by_used_bits(words);
  }
}

constexpr std::uint8_t kFrameControlTypeMask = 0x0c;
constexpr std::uint8_t kFrameControlTypeControl = 0x04;

void read_version_2(const ByteReader& reader, CsiFragment& fragment) {
  fragment.power_dbm.fill(reader.i8(2));
  fragment.common_power = true;
  fragment.control_frame = (reader.u8(3) & kFrameControlTypeMask) == kFrameControlTypeControl;
  fragment.overwritten_first = fragment.total_tones == 64 ? 28 : 0;
  fragment.overwritten_count = 3;
}

}  // namespace

bool resembles_nexmon(std::span<const std::byte> payload) {
  return has_nexmon_magic(payload) && tones_of(payload) != 0;
}

NexmonVersion nexmon_version(std::span<const std::byte> payload) {
  return ByteReader(payload).u16(2) == kNexmonMagic ? NexmonVersion::kV1 : NexmonVersion::kV2;
}

DecodeResult NexmonDecoder::decode(std::span<const std::byte> payload) const {
  if (payload.size() < kNexmonHeaderBytes) {
    return tl::make_unexpected(RejectReason::kTooShort);
  }
  const std::size_t tones = tones_of(payload);
  if (tones == 0) {
    return tl::make_unexpected(RejectReason::kLengthMismatch);
  }
  if (!has_nexmon_magic(payload)) {
    return tl::make_unexpected(RejectReason::kBadMagic);
  }
  if (nexmon_version(payload) != version_) {
    return tl::make_unexpected(RejectReason::kWrongVersion);
  }
  const ByteReader reader(payload);
  const std::uint16_t raw_configuration = reader.u16(12);
  const unsigned configuration =
      raw_configuration > 0x3f ? raw_configuration >> 8U : raw_configuration;
  const unsigned rx_chain = configuration & 7U;
  const unsigned stream = configuration >> 3U;
  if (rx_chain >= kMaxRxChains) {
    return tl::make_unexpected(RejectReason::kRxChainRange);
  }
  if (stream >= kMaxStreams) {
    return tl::make_unexpected(RejectReason::kStreamRange);
  }
  CsiFragment fragment;
  fragment.format = format();
  fragment.transmitter = nexmon_transmitter(reader);
  fragment.digest = payload_digest(payload);
  fragment.channel = nexmon_channel(payload);
  fragment.sequence_control = reader.u16(10);
  fragment.rx_chain = static_cast<std::uint8_t>(rx_chain);
  fragment.stream = static_cast<std::uint8_t>(stream);
  fragment.tones = static_cast<std::uint16_t>(tones);
  fragment.total_tones = fragment.tones;
  fragment.channel_bandwidth_mhz = nexmon_bandwidth_mhz(tones);
  fragment.words = reader.bytes(kNexmonHeaderBytes, kBytesPerWord * tones);
  fragment.layout = layout_of(reader.u16(16), fragment.words);
  if (version_ == NexmonVersion::kV2) {
    read_version_2(reader, fragment);
  }
  return fragment;
}

const DecoderRow kNexmonV1Row{
    .name = "nexmon-v1",
    .resembles =
        [](std::span<const std::byte> payload) {
          return resembles_nexmon(payload) && nexmon_version(payload) == NexmonVersion::kV1;
        },
    .make = []() -> AnyDecoder { return std::make_unique<NexmonDecoder>(NexmonVersion::kV1); }};

const DecoderRow kNexmonV2Row{
    .name = "nexmon-v2",
    .resembles =
        [](std::span<const std::byte> payload) {
          return resembles_nexmon(payload) && nexmon_version(payload) == NexmonVersion::kV2;
        },
    .make = []() -> AnyDecoder { return std::make_unique<NexmonDecoder>(NexmonVersion::kV2); }};

}  // namespace rayloc
