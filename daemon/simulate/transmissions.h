// What a device sends in a simulation, and from where: the same for every access point that hears
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "daemon/survey/points_csv.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

struct Transmission {
  Timestamp time;
  std::uint16_t sequence_control = 0;  // of 802.11: number << 4
  std::uint64_t error_seed = 0;        // of the transmitter's own error in this frame
  std::size_t channel = 0;             // of those that the device hops over, a position
};

struct SimulatedSpot {
  int line = 0;    // of the points file
  Vec3d position;  // [m], where the device really stands
  std::vector<Transmission> frames;
  Orientation orientation = {};  // of the device; world from device
  double power_db = 0.0;         // of the device beside its usual power
  Timestamp t_start = {};        // of the points file
  Timestamp t_end = {};
};

struct TransmissionOptions {
  std::size_t frames = 10;    // at each point, spread evenly over its time
  double survey_error = 0.0;  // [m], deviation along each axis of the device from the stated point
  double retry_share = 0.0;
  // The points are instants of a walk: the device sends one frame at each, and stands where stated.
  bool walk = false;
  // That the device hops over: each frame is on the next one, after the last on the first again.
  std::size_t channels = 1;
  std::uint64_t seed = 0;
};

// In order of time. An Error names the row of `file` where frames do not fit: a device sends one at
// a time, at most every kLeastFrameInterval.
inline constexpr Duration kLeastFrameInterval = std::chrono::microseconds(200);
Expected<std::vector<SimulatedSpot>> plan_transmissions(std::span<const SurveyPoint> points,
                                                        const TransmissionOptions& options,
                                                        const std::string& file);

}  // namespace rayloc
