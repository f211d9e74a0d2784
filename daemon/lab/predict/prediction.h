// predict: expected accuracy of device localization in a room before access points are mounted.
//
// At places of a lattice, channels are drawn from the distribution that the likelihood assumes
// (daemon/lab/simulate/channel_draw.h), received by the usual radio, and located by the Localizer.
// The errors therefore contain only the uncertainty of the room model, the radio and the ambiguity
// of positions; clutter, which no plan contains, is not included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/localize/path_grid.h"
#include "engine/room/room_model.h"

namespace rayloc {

// [m], chosen: larger errors are no spread of one mode; the estimate is at another place.
inline constexpr double kAnotherPlace = 0.5;

struct PredictionOptions {
  std::size_t draws = 3;   // bursts per place
  std::size_t frames = 3;  // in a burst at an access point
  int bandwidth_mhz = 40;
  std::uint64_t seed = 1;
  std::shared_ptr<PathGridStore> path_grids = nullptr;   // may be null
  std::function<void(double share)> progress = nullptr;  // share of the work done
};

struct PredictedPlace {
  Vec3d position;
  std::vector<double> error;    // [m], horizontal, by draw; infinite without a fix
  std::vector<Vec3d> estimate;  // by draw; NaN without a fix
};

struct Prediction {
  std::vector<PredictedPlace> places;
  double median_m = 0.0;  // over all draws
  double p90_m = 0.0;
  double another_place = 0.0;  // share of draws with an error above kAnotherPlace
};

// The share of these errors above kAnotherPlace. REQUIRES: not empty.
double misplaced_share(std::span<const double> errors);

// Places of the lattice inside the room, at the height of the device, and outside solids.
std::vector<Vec3d> predicted_places(const RoomModel& room, double step);

// Returns an Error if the room cannot be modelled. REQUIRES: every access point has chain gains.
Expected<Prediction> predict(const std::shared_ptr<const RoomModel>& room,
                             const std::vector<Vec3d>& places,
                             const PredictionOptions& options);

// Places that are confused: located at `taken_for` in `count` of `draws`.
struct ConfusedPlace {
  Vec3d place;
  Vec3d taken_for;
  std::size_t count = 0;
  std::size_t draws = 0;
};
// The most frequent first, at most `most`.
std::vector<ConfusedPlace> confused_places(const Prediction& prediction, std::size_t most);

}  // namespace rayloc
