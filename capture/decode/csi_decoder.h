// CsiDecoder: converts the payload of one datagram to the fragment of a CSI frame in it.
//
// A decoder is one wire format: its file begins with the table of the layout. It checks, in this
// order, the length, the magic number, the version and the ranges of the fields; an accepted
// datagram needs no further check. It keeps no state between datagrams.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <tl/expected.hpp>

#include "capture/decode/csi_words.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/channel/radio_channel.h"

namespace rayloc {

inline constexpr std::size_t kMaxRxChains = 4;
inline constexpr std::size_t kMaxStreams = 4;
inline constexpr std::size_t kMaxSlots = kMaxRxChains * kMaxStreams;
inline constexpr std::size_t kMaxTones = 2048;
// Blocks of tones in which fragments are accounted for: a fragment begins and ends at a multiple.
inline constexpr std::size_t kToneBlock = 64;

// The reason for which a datagram was rejected; to_string returns the name of its counter.
enum class RejectReason : std::uint8_t {
  kTooShort,
  kUnknownFormat,
  kLengthMismatch,
  kBadMagic,
  kWrongVersion,
  kRxChainRange,
  kStreamRange,
  kToneRange,
  kEncodingRange,
  kHeaderMismatch,       // two copies of a field in the same header differ
  kAntennaPermutation,   // the assignment of antennas to chains is no permutation
  kLegacyRate,           // a frame without HT, for which the card measures no channel
  kFrameMismatch,        // the header contradicts earlier fragments of the same frame
  kOtherChannel,         // the header states another channel than the site
  kSeveralAccessPoints,  // several access points send to the source (mixture_detector.h)
  kGroupAddress,         // the transmitter address is a group address, which no device has
  kZeroAddress,          // the transmitter address is zero
};
inline constexpr std::size_t kRejectReasons = 17;
std::string_view to_string(RejectReason reason);

struct CsiFragment {
  std::string_view format;
  MacAddress transmitter;
  // The extractor's frame counter. Without one (nexmon) `digest` distinguishes fragments.
  bool has_sequence = false;
  std::uint16_t sequence = 0;
  std::uint64_t digest = 0;  // digest of the CSI in wire order (payload_digest.h)
  std::uint16_t sequence_control = 0;
  bool control_frame = false;  // its sequence control is left over from an earlier frame

  std::uint8_t rx_chain = 0;  // < kMaxRxChains
  std::uint8_t stream = 0;    // < kMaxStreams
  // Tones [first_tone, first_tone + tones) of `total_tones`, in the order of the wire.
  std::uint16_t first_tone = 0;
  std::uint16_t tones = 0;
  std::uint16_t total_tones = 0;

  std::optional<PhyFormat> phy;         // if the header states it
  int channel_bandwidth_mhz = 0;        // bandwidth by the size of the transform
  std::optional<RadioChannel> channel;  // if the header states one
  int transmitted_streams = 0;          // 0: not stated in the header
  std::uint16_t expected_slots = 0;     // bit slot(core, stream); 0: not stated in the header

  std::array<std::optional<std::int8_t>, kMaxRxChains> power_dbm;
  bool common_power = false;  // one value for the frame, repeated for every core

  // Indices on the wire that the extractor overwrote with other data.
  std::uint16_t overwritten_first = 0;
  std::uint16_t overwritten_count = 0;

  CsiWords layout = CsiWords::kFloat12;
  std::span<const std::byte> words;  // 4 bytes a tone; valid as long as the payload
};

constexpr std::size_t slot_of(std::size_t rx_chain, std::size_t stream) {
  return rx_chain * kMaxStreams + stream;
}

using DecodeResult = tl::expected<CsiFragment, RejectReason>;

class CsiDecoder {
 public:
  CsiDecoder() = default;
  CsiDecoder(const CsiDecoder&) = delete;
  CsiDecoder& operator=(const CsiDecoder&) = delete;
  virtual ~CsiDecoder() = default;

  virtual std::string_view format() const = 0;  // static storage
  virtual DecodeResult decode(std::span<const std::byte> payload) const = 0;
};

}  // namespace rayloc
