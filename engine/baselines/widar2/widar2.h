// Widar2.0: locates a walking person with one link: the rate of the length of the path via the
// person, its length and its bearing [W2].
//
// The frames of an access point become conjugate products, the band of motion is kept, SAGE
// estimates the paths of every window, PathLink selects those of the target, and RangeSmoother
// filters the length. A length and a bearing give a place: r = (D^2 - |x_T|^2) / (2 (D - x_T . e)).
//
// Ours: the place as a map, with phases on the circle, so that every matching direction stays a
// hypothesis and none is selected; several access points multiply their maps; motion is detected
// against noise; a gap restarts the method.
//
// References: [W2] K. Qian et al., Widar2.0, ACM MobiSys 2018.
// Thread safety: use from one thread only.
#pragma once

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
#include "engine/baselines/motion/motion_sage.h"
#include "engine/baselines/motion/range_smoother.h"
#include "engine/baselines/paths/bearing.h"
#include "engine/baselines/widar2/path_link.h"
#include "engine/baselines/widar2/widar2_options.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Source of the frames.
struct Widar2Link {
  MacAddress transmitter;
  Vec3d position;                          // [m]
  std::vector<std::size_t> access_points;  // receivers
};

// The distance in plan at which a path via it has this length. `to_transmitter`: from the receiver,
// in plan; `direction`: unit vector. Not positive: no such place.
double range_of(double length, const Vec3d& to_transmitter, const Vec3d& direction);

class Widar2 {
 public:
  // Maximum delay of a position after the last frame.
  static constexpr Duration kMaxLag = std::chrono::milliseconds(2500);

  // An Error without a calibrated access point that has two antennas in a line.
  static Expected<Widar2> create(std::shared_ptr<const RoomModel> room,
                                 Widar2Link link,
                                 const Widar2Options& options);

  // Appends a position for every window that these frames complete. `frames`: of the link's
  // transmitter, in order of time.
  void receive(std::span<const CsiFrame> frames, std::vector<LocationEstimate>& out);
  // Reason why there is no position so far; empty: there is one.
  const std::string& problem() const { return problem_; }
  void restart();

 private:
  struct Receiver {
    std::size_t access_point = 0;
    AntennaLine line;
    FrameSeries series;  // [antenna of the line][tone], phases from the first antenna
    std::optional<Timestamp> next = std::nullopt;  // window
    std::optional<MotionSage> sage = std::nullopt;
    Duration sample{};
    double still_s = 0.0;
    PathLink link;
    RangeSmoother range;
    // For windows whose length is not smoothed yet.
    std::vector<double> psi = {};
  };
  // Measurement of an access point in a window.
  struct Received {
    const Receiver* receiver = nullptr;
    SmoothedRange range;
    double psi = 0.0;
  };

  Widar2(std::shared_ptr<const RoomModel> room, Widar2Link link, const Widar2Options& options);
  void take(const CsiFrame& frame);
  void begin_anew(Receiver& receiver) const;
  bool is_ready();
  bool is_complete(Timestamp window) const;
  std::optional<Received> receive_window(Receiver& receiver, Timestamp window);
  Eigen::MatrixXcd samples_of(const Receiver& receiver, Timestamp from, Timestamp to) const;
  LocationEstimate estimate(std::span<const Received> received, Timestamp time) const;

  std::shared_ptr<const RoomModel> room_;
  Widar2Link link_;
  Widar2Options options_;
  std::vector<std::size_t> tones_;  // of the grid
  std::vector<Receiver> receivers_;
  std::optional<Timestamp> window_;  // the next window
  std::string problem_;
};

}  // namespace rayloc
