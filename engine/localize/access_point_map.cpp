#include "engine/localize/access_point_map.h"

#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/parallel.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/room/ray.h"
#include "engine/scene/scene.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
struct AccessPointMap::Tracing {
  const Source source;
  const ReceiverTracer tracer;
  PathGrid rays;  // of each cell's centre

  std::vector<Ray> rays_to(const Vec3d& position) const {
    const DeviceModel& device = source.room->device;
    const Transmitter transmitter{{position, {}, device.pattern, device.polarization}};
    return rays_of(tracer.trace(transmitter), *source.room, position, kMostRays);
  }

  Tracing(const Source& of, PathGridStore* store)
      : source(of),
        tracer(PathTracer(of.room->scene, of.room->trace)
                   .at(array_origin<Receiver>(of.room->access_points[of.access_point].array))) {
    const RoomGrid& grid = source.grid;
    const RoomModel& room = *source.room;
    rays = make_path_grid(
        {grid.size(), [&](std::size_t cell) { return rays_to(grid.centre(cell)); }},
        path_grid_key(room, room.access_points[source.access_point], grid, kMostRays),
        store);
  }
};

AccessPointMap::AccessPointMap(const Source& source,
                               std::shared_ptr<const Tracing> tracing,
                               std::vector<Vec3d> offsets)
    : source_(source),
      offsets_(std::move(offsets)),
      likelihood_(Likelihood::make(source.likelihood, source.room->grid, offsets_.size())),
      model_(source.room->grid, offsets_.size()),
      tracing_(std::move(tracing)),
      nowhere_(likelihood_->nowhere(access_point().error)) {
  build_cells();
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    without_.push_back(std::make_unique<Lazy<AccessPointMap>>());
  }
}

AccessPointMap::AccessPointMap(const Source& source, PathGridStore* store)
    : AccessPointMap(source,
                     std::make_shared<const Tracing>(source, store),
                     offsets_of(source.room->access_points[source.access_point].array)) {}

AccessPointMap::~AccessPointMap() = default;
AccessPointMap::AccessPointMap(AccessPointMap&&) noexcept = default;

const AccessPointMap& AccessPointMap::without(std::size_t antenna) const {
  RAYLOC_CHECK(antenna < offsets_.size() && offsets_.size() > 1);
  return without_[antenna]->get([&] {
    std::vector<Vec3d> left = offsets_;
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(antenna));
    return std::unique_ptr<AccessPointMap>(new AccessPointMap(source_, tracing_, std::move(left)));
  });
}

const RoomAccessPoint& AccessPointMap::access_point() const {
  return source_.room->access_points[source_.access_point];
}

double AccessPointMap::cell_size() const {
  return std::sqrt(source_.grid.step_x * source_.grid.step_y);
}

void AccessPointMap::build_cells() {
  const ModelError& error = access_point().error;
  cells_.resize(source_.grid.size());
  level_db_.resize(cells_.size());
  parallel_for(cells_.size(), 16, [&](std::size_t cell) {
    if (!tracing_->rays[cell].empty()) {
      level_db_[cell] = traced_level_db(tracing_->rays[cell], error);
    }
    cells_[cell] = likelihood_->place({tracing_->rays[cell], offsets_, cell_size()}, error);
  });
}

ObservedBurst AccessPointMap::observe(std::span<const std::complex<double>> h, double noise) const {
  ObservedBurst observed = likelihood_->observe(h);
  observed.array.noise = noise;
  return observed;
}

Likelihood::Coarse AccessPointMap::coarse(std::size_t cell, const ObservedBurst& observed) const {
  return likelihood_->coarse(cells_[cell], observed);
}

void AccessPointMap::fetch(std::size_t cell) const {
  if (cell < cells_.size()) {
    rayloc::fetch(cells_[cell].model.whitener);
  }
}

double AccessPointMap::log_likelihood(std::size_t cell,
                                      const ObservedBurst& observed,
                                      std::uint8_t windows) const {
  return likelihood_->log_likelihood(cells_[cell], observed, windows);
}

std::vector<double> AccessPointMap::level_log_likelihood(const HeardLevel& heard) const {
  std::vector<double> result(cells_.size());
  std::vector<double> reachable;
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    if (is_reachable(cell)) {
      result[cell] = heard.log_likelihood(level_db_[cell]);
      reachable.push_back(result[cell]);
    }
  }
  if (reachable.empty()) {
    return result;
  }
  const double mean = log_mean_exp(reachable, 1.0);
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    result[cell] -= is_reachable(cell) ? mean : 0.0;
  }
  return result;
}

double AccessPointMap::nowhere(const ObservedBurst& observed) const {
  return likelihood_->log_likelihood(nowhere_, observed);
}

std::unique_ptr<const NearbyLikelihood> AccessPointMap::nearby(
    std::size_t cell, const ObservedBurst& observed) const {
  return likelihood_->nearby(
      {tracing_->rays[cell], offsets_, cell_size()}, cells_[cell], access_point().error, observed);
}

std::vector<Ray> AccessPointMap::rays_to(const Vec3d& position) const {
  return tracing_->rays_to(position);
}

std::optional<double> AccessPointMap::covered_log_odds(std::span<const Ray> rays,
                                                       const ObservedBurst& observed) const {
  return rays.empty() || source_.likelihood != LikelihoodKind::kPartial
             ? std::nullopt
             : ObservationModel::covered_log_odds(
                   model_.place_of_burst(
                       {rays, offsets_, 0.0}, access_point().error, observed.array),
                   observed.array);
}

std::vector<std::complex<double>> AccessPointMap::expected(std::span<const Ray> rays) const {
  return model_.expected({rays, offsets_, 0.0}, access_point().error);
}

}  // namespace rayloc
