#include "engine/localize/localizer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/parallel.h"
#include "engine/localize/hearing.h"
#include "engine/localize/observation_model.h"
#include "engine/localize/posterior.h"
#include "engine/localize/ray.h"
#include "engine/observe/alignment.h"
#include "engine/scene/scene.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

// About this many cells a room: 5 cm in a small room, more in a large one.
constexpr double kCells = 6000.0;
constexpr double kFinestStep = 0.05;  // [m]
constexpr std::size_t kMostRays = 64;
// Cells whose coarse log-likelihood is this far below the best are not looked at again. The coarse
// search misses a delay by 3 ns at most, which costs about 10.
constexpr double kCoarseMargin = 35.0;
constexpr double kFarBelow = 1e4;
// Of a burst from this room nearly all power lies within the basis of delays; of noise q / tones.
constexpr double kLeastCaptured = 0.5;
constexpr double kLeastResidual = 1e-30;

// One access point that can be used, and its part of the map.
struct Station {
  std::size_t index;  // in RoomModel::access_points
  ObservationModel model;
  std::vector<Vec3d> element_offset;
  ReceiverTracer tracer;
  std::vector<PlaceModel> cells;
  PlaceModel nowhere;
};

std::vector<Vec3d> offsets_of(const AntennaArray& array) {
  std::vector<Vec3d> offsets;
  for (std::size_t i = 0; i < array.element_offset.size(); ++i) {
    offsets.push_back(element_position(array, i) - array.pose.position);
  }
  return offsets;
}

Receiver centre_of(const AntennaArray& array) {
  return Receiver{{array.pose.position, array.pose.orientation, array.pattern, array.polarization}};
}

}  // namespace

class Localizer::Impl {
 public:
  Impl(std::shared_ptr<const RoomModel> room, const LocalizerOptions& options)
      : room_(std::move(room)), options_(options), grid_(make_grid(*room_)) {}

  void build() {
    const PathTracer tracer(room_->scene, room_->trace);
    for (std::size_t i = 0; i < room_->access_points.size(); ++i) {
      const RoomAccessPoint& ap = room_->access_points[i];
      const std::string problem = calibration_problem(*room_, ap);
      if (!problem.empty()) {
        warnings_.push_back("access point " + ap.id + " " + problem);
        continue;
      }
      stations_.push_back({i,
                           ObservationModel(room_->grid, ap.cores.size()),
                           offsets_of(ap.array),
                           tracer.at(centre_of(ap.array)),
                           {},
                           {}});
      build_cells(stations_.back());
    }
  }

  Hearing hear_burst(std::span<const CsiFrame> frames) const;
  // far_below: taken from the cells that are not looked at closely.
  std::vector<double> map_of(const std::vector<HeardArray>& heard, double far_below) const;
  LocationEstimate locate(std::span<const CsiFrame> frames, double temper) const;
  const RoomModel& room() const { return *room_; }
  const RoomGrid& grid() const { return grid_; }
  const LocalizerOptions& options() const { return options_; }

 private:
  static RoomGrid make_grid(const RoomModel& room) {
    const double area =
        (room.bounds_max.x - room.bounds_min.x) * (room.bounds_max.y - room.bounds_min.y);
    return {room.bounds_min,
            room.bounds_max,
            room.device.height,
            std::max(kFinestStep, std::sqrt(area / kCells))};
  }

  std::vector<Ray> rays_to(const Station& station, const Vec3d& position) const {
    const DeviceModel& device = room_->device;
    const Transmitter transmitter{{position, {}, device.pattern, device.polarization}};
    return rays_of(station.tracer.trace(transmitter), *room_, position, kMostRays);
  }

  void build_cells(Station& station) const {
    const ModelError& error = room_->access_points[station.index].error;
    station.nowhere = station.model.nowhere(error);
    station.cells.resize(grid_.size());
    const double size = std::sqrt(grid_.step_x * grid_.step_y);
    parallel_for(grid_.size(), 16, [&](std::size_t cell) {
      const auto rays = rays_to(station, grid_.centre(cell));
      station.cells[cell] = station.model.place({rays, station.element_offset, size}, error);
    });
  }

  std::vector<HeardArray> listen(std::span<const CsiFrame> frames,
                                 LocationEstimate& estimate) const;
  std::optional<HeardArray> heard_by(std::size_t number,
                                     const BurstObservation& burst,
                                     LocationEstimate& estimate) const;
  double model_residual(const std::vector<HeardArray>& heard, const Vec3d& position) const;

  std::shared_ptr<const RoomModel> room_;
  LocalizerOptions options_;
  RoomGrid grid_;
  std::vector<Station> stations_;
  std::vector<std::string> warnings_;
};

// Of a burst that is a channel of this room.
std::optional<HeardArray> Localizer::Impl::heard_by(std::size_t number,
                                                    const BurstObservation& burst,
                                                    LocationEstimate& estimate) const {
  const Station& station = stations_[number];
  const RoomAccessPoint& ap = room_->access_points[station.index];
  HeardArray heard{number, station.model.observe(burst.h), burst.h, 1.0};
  if (heard.observed.captured < kLeastCaptured) {
    estimate.warnings.push_back("access point " + ap.id +
                                ": what it heard is no channel of this room");
    return std::nullopt;
  }
  // The map's covariances hold the model's noise only; a weak burst counts less.
  const double in_basis = burst.noise_variance * static_cast<double>(station.model.dimension()) /
                          static_cast<double>(heard.h.size());
  heard.weight = ap.error.noise / (ap.error.noise + in_basis);
  return heard;
}

std::vector<HeardArray> Localizer::Impl::listen(std::span<const CsiFrame> frames,
                                                LocationEstimate& estimate) const {
  std::vector<HeardArray> heard;
  HearingTally tally;
  for (std::size_t number = 0; number < stations_.size(); ++number) {
    const Station& station = stations_[number];
    const auto burst =
        rayloc::hear(*room_, station.index, frames, options_.burst, estimate.warnings);
    auto one = burst ? heard_by(number, *burst, estimate) : std::nullopt;
    if (one) {
      tally.add(room_->access_points[station.index], *burst);
      heard.push_back(*std::move(one));
    }
  }
  tally.fill(frames, estimate);
  return heard;
}

// Log-likelihood of every cell above that of being nowhere in particular.
std::vector<double> Localizer::Impl::map_of(const std::vector<HeardArray>& heard,
                                            double far_below) const {
  std::vector<double> nowhere;
  nowhere.reserve(heard.size());
  for (const HeardArray& one : heard) {
    nowhere.push_back(
        ObservationModel::log_likelihood(stations_[one.station].nowhere, one.observed));
  }
  const auto sum = [&](std::size_t cell, auto log_likelihood) {
    double total = 0.0;
    for (std::size_t i = 0; i < heard.size(); ++i) {
      const PlaceModel& place = stations_[heard[i].station].cells[cell];
      if (place.reachable) {
        total += heard[i].weight * (log_likelihood(place, heard[i].observed) - nowhere[i]);
      }
    }
    return total;
  };
  std::vector<double> map(grid_.size());
  parallel_for(map.size(), 64, [&](std::size_t cell) {
    map[cell] = sum(cell, ObservationModel::coarse_log_likelihood);
  });
  const double least = *std::max_element(map.begin(), map.end()) - kCoarseMargin;
  parallel_for(map.size(), 64, [&](std::size_t cell) {
    map[cell] =
        map[cell] >= least ? sum(cell, ObservationModel::log_likelihood) : map[cell] - far_below;
  });
  return map;
}

double Localizer::Impl::model_residual(const std::vector<HeardArray>& heard,
                                       const Vec3d& position) const {
  double residual = 0.0;
  const Aligner aligner(room_->grid);
  for (const HeardArray& one : heard) {
    const Station& station = stations_[one.station];
    const auto rays = rays_to(station, position);
    const auto expected = station.model.expected({rays, station.element_offset, 0.0},
                                                 room_->access_points[station.index].error);
    residual += 1.0 - aligner.align(expected, one.h).correlation;
  }
  return 10.0 * std::log10(std::max(residual / static_cast<double>(heard.size()), kLeastResidual));
}

Hearing Localizer::Impl::hear_burst(std::span<const CsiFrame> frames) const {
  Hearing hearing;
  LocationEstimate& estimate = hearing.estimate;
  estimate.warnings = warnings_;
  estimate.accuracy_confidence = options_.accuracy_confidence;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return hearing;
  }
  hearing.arrays = listen(frames, estimate);
  if (hearing.arrays.empty()) {
    estimate.reason = estimate.warnings.empty() ? "no access point of the site heard the burst"
                                                : estimate.warnings.front();
  }
  return hearing;
}

LocationEstimate Localizer::Impl::locate(std::span<const CsiFrame> frames, double temper) const {
  Hearing hearing = hear_burst(frames);
  LocationEstimate& estimate = hearing.estimate;
  if (hearing.arrays.empty()) {
    return std::move(estimate);
  }
  const auto map = map_of(hearing.arrays, kFarBelow);
  const double best = *std::max_element(map.begin(), map.end());
  if (best <= 0.0) {
    estimate.reason = "no place of the room explains the burst better than diffuse scattering";
    estimate.loss = -best;
    return std::move(estimate);
  }
  summarise_posterior(
      grid_, map, {temper, options_.accuracy_confidence, options_.max_hypotheses}, estimate);
  if (estimate.position) {
    estimate.model_residual_db = model_residual(hearing.arrays, *estimate.position);
  }
  return std::move(estimate);
}

Expected<Localizer> Localizer::create(std::shared_ptr<const RoomModel> room,
                                      const LocalizerOptions& options) {
  if (room == nullptr || room->scene == nullptr) {
    return make_error(ErrorKind::kInternal, "a localizer needs a room with a scene");
  }
  if (!(room->bounds_max.x > room->bounds_min.x && room->bounds_max.y > room->bounds_min.y)) {
    return make_error(ErrorKind::kConfiguration, "the room's bounds are empty");
  }
  if (room->access_points.empty() || room->grid.size() < 2) {
    return make_error(ErrorKind::kConfiguration, "the site has no access point or no tones");
  }
  auto impl = std::make_unique<Impl>(std::move(room), options);
  impl->build();
  return Localizer(std::move(impl));
}

Localizer::Localizer(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

LocationEstimate Localizer::locate(std::span<const CsiFrame> frames) const {
  return impl_->locate(frames, impl_->room().temper);
}
LocationEstimate Localizer::locate(std::span<const CsiFrame> frames, double temper) const {
  return impl_->locate(frames, temper);
}

Hearing Localizer::hear(std::span<const CsiFrame> frames) const {
  return impl_->hear_burst(frames);
}
std::vector<double> Localizer::log_likelihood(const Hearing& hearing) const {
  RAYLOC_CHECK(!hearing.arrays.empty());
  return impl_->map_of(hearing.arrays, 0.0);
}

const RoomGrid& Localizer::grid() const { return impl_->grid(); }
const RoomModel& Localizer::room() const { return impl_->room(); }
const LocalizerOptions& Localizer::options() const { return impl_->options(); }

}  // namespace rayloc
