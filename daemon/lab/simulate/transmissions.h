// Transmissions of a simulated device, with their positions:
// the same for every access point that receives them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "daemon/site/survey/points_csv.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

struct Transmission {
  Timestamp time;
  std::uint16_t sequence_control = 0;  // 802.11 field: number << 4
  std::uint64_t error_seed = 0;        // seed of the transmitter's own error in this frame
  std::size_t channel = 0;             // index among the hop channels of the device
};

struct SimulatedPoint {
  int line = 0;    // in the points file
  Vec3d position;  // [m], true position of the device
  std::vector<Transmission> frames;
  Orientation orientation = {};  // world from device
  double power_db = 0.0;         // device power relative to its usual power
  Timestamp t_start = {};        // from the points file
  Timestamp t_end = {};
};

struct TransmissionOptions {
  std::size_t frames = 10;    // per point, spread evenly over its time
  double survey_error = 0.0;  // [m], deviation of the device from the stated point, on each axis
  double retry_share = 0.0;
  // The points are instants of a walk: the device sends one frame at each, at the stated place.
  bool walk = false;
  // Number of hop channels: successive frames use successive channels, cyclically.
  std::size_t channels = 1;
  std::uint64_t seed = 0;
};

// In order of time. An Error names the row of `file` at which frames do not fit: a device sends one
// at a time, at most every kMinFrameInterval.
inline constexpr Duration kMinFrameInterval = std::chrono::microseconds(200);
Expected<std::vector<SimulatedPoint>> plan_transmissions(std::span<const SurveyPoint> points,
                                                         const TransmissionOptions& options,
                                                         const std::string& file);

}  // namespace rayloc
