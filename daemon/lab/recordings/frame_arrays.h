// FrameArrays: the frames of recordings as arrays, for numpy: one of all
// values, a mask of the measured ones, and one header per frame.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// Without padding, as read by numpy. Texts end with zeros, and are truncated if too long.
struct FrameHeader {
  std::int64_t time = 0;        // [ns] since 1970, UTC
  std::int64_t time_last = 0;   // [ns]
  double tone_spacing = 0.0;    // [Hz]
  double channel_centre = 0.0;  // [Hz], 0 if the format states no channel
  std::int32_t access_point = 0;
  std::int32_t bandwidth_mhz = 0;
  std::int32_t channel_bandwidth_mhz = 0;
  std::int32_t streams = 0;
  std::uint16_t sequence = 0;
  std::uint16_t sequence_control = 0;
  bool complete = false;
  std::array<char, 17> transmitter{};
  std::array<char, 16> format{};
  std::array<char, 7> phy{};
  std::array<char, 67> flags{};  // separated by commas
};
static_assert(sizeof(FrameHeader) == 160, "kFrameHeaderDescr has its fields, without padding");

inline constexpr const char* kFrameHeaderDescr =
    "[('time', '<M8[ns]'), ('time_last', '<M8[ns]'), ('tone_spacing', '<f8'), ('channel_centre', "
    "'<f8'), "
    "('access_point', '<i4'), ('bandwidth_mhz', '<i4'), ('channel_bandwidth_mhz', '<i4'), "
    "('streams', '<i4'), ('sequence', '<u2'), ('sequence_control', '<u2'), ('complete', '|b1'), "
    "('transmitter', '|S17'), ('format', '|S16'), ('phy', '|S7'), ('flags', '|S67')]";

struct FrameArrays {
  std::vector<std::uint8_t> rx_chains;   // union over all frames, ascending
  std::vector<std::int16_t> tone_index;  // union over all frames, ascending
  std::vector<FrameHeader> headers;      // [frame]
  std::vector<std::complex<float>> csi;  // [frame][rx_chain][tone], 0 if not measured
  std::vector<std::uint8_t> mask;        // same indices, 1 if measured
  std::vector<float> power_dbm;          // [frame][rx_chain], NaN if unknown

  std::vector<std::size_t> shape() const {
    return {headers.size(), rx_chains.size(), tone_index.size()};
  }
};

// For one spatial stream; frames with fewer streams have no measured values.
FrameArrays frame_arrays(std::span<const CsiFrame> frames, std::size_t stream = 0);

// Writes an .npz of these names, and `access_points`: names indexed by FrameHeader::access_point.
Expected<void> write_npz(const FrameArrays& arrays,
                         const std::vector<std::string>& access_points,
                         const std::string& path);

}  // namespace rayloc
