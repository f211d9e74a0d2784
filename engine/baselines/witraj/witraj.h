// Witraj: tracks a walking person by adding steps to a known start [WT].
//
// The ratio of the outer antennas of each access point gives the rate of the length of the path
// from the transmitter via the person (path_rate.h). Two smoothings are tried; the median of 12
// tones is used; of three access points the one with the least even rotation is dropped.
// plan_step() gives a step. A position is reported every kStepSamples samples, kLag later.
//
// Ours: damping near the line of sight, steps of at most v_max that stay in the room, the test for
// a standing person, the treatment of gaps, and the uncertainty, which grows with every step. The
// paper's classifier of walking on the spot is not implemented.
//
// References: [WT] D. Wu et al., WiTraj, IEEE TMC 2023.
// Thread safety: use from one thread only.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/baselines/motion/frame_series.h"
#include "engine/baselines/motion/path_rate.h"
#include "engine/baselines/paths/bearing.h"
#include "engine/baselines/witraj/witraj_options.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Source of the frames.
struct WitrajLink {
  MacAddress transmitter;
  Vec3d position;                          // [m]
  std::vector<std::size_t> access_points;  // receivers
};

class Witraj {
 public:
  static constexpr std::size_t kStepSamples = 10;  // of a step, a count: 25 ms at 400 frames/s
  // Extension of a window beyond a step: three smoothings and the longest mean.
  static constexpr Duration kLag = std::chrono::milliseconds(250);

  // Maximum delay of a position after the last frame: at the beginning.
  static constexpr Duration kMaxLag = std::chrono::milliseconds(1500);

  // `start`: [m], in plan. An Error with fewer than two calibrated access points, or without a
  // start.
  static Expected<Witraj> create(std::shared_ptr<const RoomModel> room,
                                 WitrajLink link,
                                 std::optional<Vec3d> start,
                                 const WitrajOptions& options);

  // Appends a position for every step that these frames complete. `frames`: of the link's
  // transmitter, in order of time.
  void receive(std::span<const CsiFrame> frames, std::vector<LocationEstimate>& out);
  // Reason why there is no position so far; empty: there is one.
  const std::string& problem() const { return problem_; }
  // Returns to the start, at any time.
  void restart();

 private:
  struct Receiver {
    std::size_t access_point = 0;
    AntennaLine line;
    std::vector<std::size_t> tones;  // of the grid
    FrameSeries series;              // ratio of the outer antennas and its inverse, of each tone
    std::array<double, 2> power{};   // sum of their amplitudes, so far
    std::vector<std::array<double, 2>> of_tone;  // the same of each tone
    std::size_t frames = 0;
  };
  // Measurement of one access point in a window, sample by sample.
  struct Rates {
    std::vector<PathRate> of_sample;
    std::vector<char> is_moving;
  };

  Witraj(std::shared_ptr<const RoomModel> room,
         WitrajLink link,
         const Vec3d& start,
         const WitrajOptions& options);
  void take(const CsiFrame& frame);
  void process(std::vector<LocationEstimate>& out);
  bool is_ready();
  Rates rates_of(const Receiver& receiver, Timestamp from, std::size_t samples) const;
  void step(std::span<const Rates> rates, std::size_t first, std::vector<LocationEstimate>& out);
  LocationEstimate estimate() const;

  std::shared_ptr<const RoomModel> room_;
  WitrajLink link_;
  WitrajOptions options_;
  Vec3d start_;
  std::vector<Receiver> receivers_;
  Duration sample_{};              // sampling interval; 0: not determined yet
  std::optional<Timestamp> time_;  // time of the state
  Vec3d place_;
  std::array<double, 4> covariance_{};  // 2 x 2 [m^2]
  double still_s_ = 0.0;                // time without motion
  std::size_t cut_ = 0;                 // steps that were clipped by v_max or the room
  std::size_t gaps_ = 0;
  std::string problem_;
};

}  // namespace rayloc
