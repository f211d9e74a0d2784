// Layout of a record, little-endian, from its code on (WIRE_FORMATS 1.9):
//
//   offset size  field
//    0     1     0xbb
//    1     4     the card's clock [us]
//    5     2     frame counter
//    7     2     without meaning
//    9     1     receive chains R, 1 to 3
//   10     1     transmit streams T, 1 to 3
//   11     3     RSSI of antennas A, B, C, less 44 dB and the gain below; 0: not used
//   14     1     noise [dBm], signed; -127: unknown
//   15     1     gain of the receiver [dB]
//   16     1     antenna of each receive chain, two bits each from the lowest
//   17     2     bytes of CSI
//   19     2     rate: bit 8 HT, bit 11 40 MHz
//   21     18    extended records alone: seconds and microseconds since 1970 (4 + 4), transmitter
//   (6),
//                a frame counter of the transmitter (4)
//   then         CSI: 30 groups of tones, each 3 bits without meaning and R x T pairs of signed
//   bytes,
//                real and imaginary, bit after bit, the stream fastest
#include "capture/decode/intel5300_decoder.h"

#include <array>
#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "capture/decode/decoder_row.h"
#include "capture/transport/byte_reader.h"
#include "engine/channel/tone_plan.h"

namespace rayloc {
namespace {

constexpr std::uint8_t kCode = 0xbb;
constexpr std::size_t kBeamformingHeaderBytes = 21;
constexpr std::size_t kExtendedHeaderBytes = 39;
constexpr std::size_t kTransmitterOffset = 29;  // offset in extended records
constexpr std::size_t kRssiOffsetBytes = 11;
constexpr std::size_t kAntennaOffset = 16;
constexpr std::size_t kMaxChains = 3;
constexpr std::size_t kTones = 30;
constexpr unsigned kGroupBits = 3;   // bits before each group of tones
constexpr unsigned kValueBits = 16;  // bits of a complex value
constexpr unsigned kHtBit = 8;
constexpr unsigned kWideBit = 11;
constexpr int kRssiOffset = 44;  // [dB]

constexpr std::array<std::int16_t, kTones> kTonesOf20 = {
    -28, -26, -24, -22, -20, -18, -16, -14, -12, -10, -8, -6, -4, -2, -1,
    1,   3,   5,   7,   9,   11,  13,  15,  17,  19,  21, 23, 25, 27, 28};
constexpr std::array<std::int16_t, kTones> kTonesOf40 = {
    -58, -54, -50, -46, -42, -38, -34, -30, -26, -22, -18, -14, -10, -6, -2,
    2,   6,   10,  14,  18,  22,  26,  30,  34,  38,  42,  46,  50,  54, 58};

std::size_t csi_bytes(std::size_t chains, std::size_t streams) {
  return (kTones * (kGroupBits + kValueBits * chains * streams) + 7) / 8;
}

// The signed byte that begins at a bit.
float value_at(std::span<const std::byte> bytes, std::size_t bit) {
  const auto low = std::to_integer<unsigned>(bytes[bit / 8]);
  const unsigned shift = bit % 8;
  const unsigned high = shift == 0 ? 0U : std::to_integer<unsigned>(bytes[bit / 8 + 1]);
  const unsigned raw = ((low | high << 8U) >> shift) & 0xffU;
  return static_cast<float>(static_cast<std::int8_t>(raw));
}

struct Header {
  std::size_t bytes = 0;
  std::size_t chains = 0;
  std::size_t streams = 0;
  unsigned rate = 0;
  std::array<std::size_t, kMaxChains> antenna{};  // antenna of each chain
};

// Returns the antenna with power if there is exactly one.
std::optional<std::size_t> only_antenna(const ByteReader& reader) {
  std::optional<std::size_t> only;
  for (std::size_t antenna = 0; antenna < kMaxChains; ++antenna) {
    if (reader.u8(kRssiOffsetBytes + antenna) != 0) {
      if (only) {
        return std::nullopt;
      }
      only = antenna;
    }
  }
  return only;
}

// Antenna of each chain; empty if the field is no permutation. A single chain needs none, and some
// logs leave the field unset then.
std::optional<std::array<std::size_t, kMaxChains>> antennas_of(const ByteReader& reader,
                                                               std::size_t chains) {
  std::array<std::size_t, kMaxChains> antennas{};
  unsigned taken = 0;
  for (std::size_t chain = 0; chain < chains; ++chain) {
    const unsigned antenna = (reader.u8(kAntennaOffset) >> (2 * chain)) & 3U;
    if (antenna >= kMaxChains || ((taken >> antenna) & 1U) != 0) {
      const auto only = chains == 1 ? only_antenna(reader) : std::nullopt;
      return only ? std::optional(std::array<std::size_t, kMaxChains>{*only}) : std::nullopt;
    }
    taken |= 1U << antenna;
    antennas.at(chain) = antenna;
  }
  return antennas;
}

tl::expected<Header, RejectReason> header_of(std::span<const std::byte> payload) {
  if (payload.size() < kBeamformingHeaderBytes) {
    return tl::make_unexpected(RejectReason::kTooShort);
  }
  const ByteReader reader(payload);
  if (reader.u8(0) != kCode) {
    return tl::make_unexpected(RejectReason::kBadMagic);
  }
  Header header;
  header.chains = reader.u8(9);
  header.streams = reader.u8(10);
  header.rate = reader.u16(19);
  if (header.chains < 1 || header.chains > kMaxChains) {
    return tl::make_unexpected(RejectReason::kRxChainRange);
  }
  if (header.streams < 1 || header.streams > kMaxChains) {
    return tl::make_unexpected(RejectReason::kStreamRange);
  }
  const std::size_t csi = csi_bytes(header.chains, header.streams);
  header.bytes = payload.size() - csi;
  if (reader.u16(17) != csi || payload.size() < csi ||
      (header.bytes != kBeamformingHeaderBytes && header.bytes != kExtendedHeaderBytes)) {
    return tl::make_unexpected(RejectReason::kLengthMismatch);
  }
  if (((header.rate >> kHtBit) & 1U) == 0) {  // the card measures HT frames only
    return tl::make_unexpected(RejectReason::kLegacyRate);
  }
  const auto antennas = antennas_of(reader, header.chains);
  if (!antennas) {
    return tl::make_unexpected(RejectReason::kAntennaPermutation);
  }
  header.antenna = *antennas;
  return header;
}

// Lists the antennas of the chains in ascending order, and the row of each in the frame.
std::array<std::size_t, kMaxChains> name_rx_chains(const Header& header, CsiFrame& frame) {
  std::array<std::size_t, kMaxChains> row{};
  for (std::size_t antenna = 0; antenna < kMaxChains; ++antenna) {
    for (std::size_t chain = 0; chain < header.chains; ++chain) {
      if (header.antenna.at(chain) == antenna) {
        row.at(chain) = frame.rx_chains.size();
        frame.rx_chains.push_back(static_cast<std::uint8_t>(antenna));
      }
    }
  }
  return row;
}

void unpack(std::span<const std::byte> bytes, const Header& header, CsiFrame& frame) {
  const auto row = name_rx_chains(header, frame);
  const TonePlan& plan = tone_plan(PhyFormat::kHt, frame.bandwidth_mhz);
  frame.csi = Csi(header.chains, header.streams, kTones);
  std::size_t bit = 0;
  std::size_t active = 0;
  for (std::size_t tone = 0; tone < kTones; ++tone) {
    while (plan.active[active] != frame.tone_index[tone]) {
      ++active;
    }
    constexpr std::array<std::complex<float>, 4> kUndo = {{{1, 0}, {0, -1}, {-1, 0}, {0, 1}}};
    const std::complex<float> undo = kUndo.at(plan.quarter_turns[active] % kUndo.size());
    bit += kGroupBits;
    for (std::size_t chain = 0; chain < header.chains; ++chain) {
      for (std::size_t stream = 0; stream < header.streams; ++stream) {
        frame.csi.row(row.at(chain), stream)[tone] =
            undo * std::complex<float>(value_at(bytes, bit), value_at(bytes, bit + 8));
        bit += kValueBits;
      }
    }
  }
}

// A record with matching lengths resembles the format, whatever rate and antennas it states.
bool resembles(std::span<const std::byte> payload) {
  if (payload.empty() || std::to_integer<std::uint8_t>(payload[0]) != kCode) {
    return false;
  }
  const auto header = header_of(payload);
  return header || header.error() == RejectReason::kLegacyRate ||
         header.error() == RejectReason::kAntennaPermutation;
}

}  // namespace

FrameResult Intel5300Decoder::decode(std::span<const std::byte> payload) const {
  const auto header = header_of(payload);
  RAYLOC_TRY(header);
  const ByteReader reader(payload);
  CsiFrame frame;
  frame.format = format();
  frame.phy = PhyFormat::kHt;
  const bool is_wide = ((header->rate >> kWideBit) & 1U) != 0;
  frame.bandwidth_mhz = frame.channel_bandwidth_mhz = is_wide ? 40 : 20;
  const auto& tones = is_wide ? kTonesOf40 : kTonesOf20;
  frame.tone_index.assign(tones.begin(), tones.end());
  frame.sequence = reader.u16(5);
  frame.transmitted_streams = static_cast<int>(header->streams);
  if (header->bytes == kExtendedHeaderBytes) {
    auto& octets = frame.transmitter.octets;
    for (std::size_t i = 0; i < octets.size(); ++i) {
      octets.at(i) = reader.u8(kTransmitterOffset + i);
    }
  }
  unpack(payload.subspan(header->bytes), *header, frame);
  const int gain = reader.u8(15);
  for (const std::uint8_t rx_chain : frame.rx_chains) {
    const int rssi = reader.u8(kRssiOffsetBytes + rx_chain);
    frame.power_dbm.push_back(
        rssi == 0 ? std::nullopt : std::optional(static_cast<float>(rssi - kRssiOffset - gain)));
  }
  frame.complete = true;
  return frame;
}

const DecoderRow kIntel5300Row{
    .name = "intel-5300", .resembles = resembles, .make = []() -> AnyDecoder {
      return std::make_unique<Intel5300Decoder>();
    }};

}  // namespace rayloc
