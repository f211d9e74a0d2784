// Witraj: a person who walks, by adding steps to a known start [WT].
//
// The ratio of the outer antennas of each access point tells how fast the path from the transmitter
// by way of the person gets longer (path_rate.h). Two smoothings are tried; of 12 tones the median
// counts; of three access points the one that turns least evenly is dropped. plan_step() turns
// rates into a step. A position is stated for every kStepSamples samples, kLag after it was.
//
// Ours: damping near the line of sight, steps of at most v_max that stay in the room, the test of
// standing still, what a gap does, and the uncertainty, which grows with every step. The paper's
// classifier of walking on the spot is not built.
//
// References: [WT] D. Wu et al., WiTraj, IEEE TMC 2023.
// Thread safety: for one thread.
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

// Where the frames come from.
struct WitrajLink {
  MacAddress transmitter;
  Vec3d position;                          // [m]
  std::vector<std::size_t> access_points;  // that hear it
};

class Witraj {
 public:
  static constexpr std::size_t kStepSamples = 10;  // of a step, a count: 25 ms at 400 frames/s
  // By which a window reaches beyond a step: three smoothings and the longest mean.
  static constexpr Duration kLag = std::chrono::milliseconds(250);

  // By which a position may be behind what was heard: at the beginning.
  static constexpr Duration kMostLag = std::chrono::milliseconds(1500);

  // `start`: [m], in plan. An Error with fewer than two calibrated access points, or without a
  // start.
  static Expected<Witraj> create(std::shared_ptr<const RoomModel> room,
                                 WitrajLink link,
                                 std::optional<Vec3d> start,
                                 const WitrajOptions& options);

  // Appends a position for every step that these frames complete. `frames`: of the link's
  // transmitter, in order of time.
  void hear(std::span<const CsiFrame> frames, std::vector<LocationEstimate>& out);
  // Why nothing follows from what was heard so far; empty: something does.
  const std::string& problem() const { return problem_; }
  // At the start again, whatever the time.
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
  // What one access point says of a window, sample by sample.
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
  Duration sample_{};              // from one to the next; 0: not known yet
  std::optional<Timestamp> time_;  // of the state
  Vec3d place_;
  std::array<double, 4> covariance_{};  // 2 x 2 [m^2]
  double still_s_ = 0.0;                // nothing has moved for so long
  std::size_t cut_ = 0;                 // steps that were longer than v_max, or left the room
  std::size_t gaps_ = 0;
  std::string problem_;
};

}  // namespace rayloc
