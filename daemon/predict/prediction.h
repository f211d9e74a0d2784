// predict: how well devices would be found in a room, before an access point hangs in it.
//
// At places of a lattice channels are drawn from the distribution that the likelihood takes them to
// have (daemon/simulate/channel_draw.h), received by the usual radio, and located by the Localizer.
// So nothing but what the model of the room leaves open, the radio and the ambiguity of the places
// is in the errors; what no plan has (clutter) is not.
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

// [m], chosen: an error that no width of a hill explains; the device is taken to be elsewhere.
inline constexpr double kAnotherPlace = 0.5;

struct PredictionOptions {
  std::size_t draws = 3;   // bursts at each
  std::size_t frames = 3;  // of a burst at an access point
  int bandwidth_mhz = 40;
  std::uint64_t seed = 1;
  std::shared_ptr<PathGridStore> path_grids = nullptr;   // may be null
  std::function<void(double share)> progress = nullptr;  // of the work done
};

struct PredictedPlace {
  Vec3d position;
  std::vector<double> error;    // [m], horizontal, of each draw; infinite without a fix
  std::vector<Vec3d> estimate;  // of each draw; NaN without a fix
};

struct Prediction {
  std::vector<PredictedPlace> places;
  double median_m = 0.0;  // of all draws
  double p90_m = 0.0;
  double another_place = 0.0;  // share of draws that are off by more than kAnotherPlace
};

// Of these errors, the share above kAnotherPlace. REQUIRES: not empty.
double share_elsewhere(std::span<const double> errors);

// Places of the lattice inside of the room, at the height of the device, and in no solid.
std::vector<Vec3d> predicted_places(const RoomModel& room, double step);

// An Error where the room cannot be modelled. REQUIRES: every access point has chain gains.
Expected<Prediction> predict(const std::shared_ptr<const RoomModel>& room,
                             const std::vector<Vec3d>& places,
                             const PredictionOptions& options);

// Places that are taken for each other: found at `taken_for` in `count` of `draws`.
struct LookAlike {
  Vec3d place;
  Vec3d taken_for;
  std::size_t count = 0;
  std::size_t draws = 0;
};
// The most frequent first, at most `most`.
std::vector<LookAlike> look_alikes(const Prediction& prediction, std::size_t most);

}  // namespace rayloc
