#include "engine/localize/access_point_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/cell_places.h"
#include "engine/room/ray.h"
#include "engine/room/ray_at_height.h"
#include "engine/scene/scene.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

// A count, chosen: boxes of a cell and a layer kept in memory, of 1.5 kB each at 40 MHz. Few boxes
// are evaluated, and mostly the same ones again: those along a walk.
constexpr std::size_t kMaxKeptBoxes = 16'384;
// Bytes, chosen: memory for the boxes of tracks, and as much for the covariances that they share. A
// walk through a room needs one or two thousand boxes.
constexpr std::size_t kFieldBytes = std::size_t{48} << 20U;
// Bytes, chosen: memory for the boxes of clouds, 12,000 of them at 40 MHz. A walk through a
// laboratory needs as many.
constexpr std::size_t kPlaceBoxBytes = std::size_t{48} << 20U;
// A count, chosen: heights in the mixture of a whole cell; each costs as much as one more
// cell.
constexpr std::size_t kMaxInColumn = 5;

// At most this many heights with the same mean and about the same spread.
std::vector<HeightSlice> coarsened(const HeightLayers& layers, std::size_t most) {
  const std::size_t count = std::min(layers.size(), most);
  std::vector<HeightSlice> coarse(count, {0.0, 0.0});
  for (std::size_t i = 0; i < layers.size(); ++i) {
    HeightSlice& slice = coarse[i * count / layers.size()];
    slice.offset += layers.weight[i] * layers.offset[i];
    slice.weight += layers.weight[i];
  }
  for (HeightSlice& slice : coarse) {
    slice.offset /= slice.weight;
  }
  return coarse;
}

double wavelength_of(const RoomModel& room) { return kSpeedOfLight / room.grid.centre_hz; }

// Number of covariances kept. `dimension`: of an observation.
std::size_t kept_covariances(std::size_t dimension) {
  const std::size_t turn = dimension * dimension * sizeof(std::complex<float>);
  return kFieldBytes / (turn + 2 * dimension * sizeof(double) + sizeof(FieldCovariance));
}

std::size_t kept_fields(std::size_t dimension, const FieldLattice& lattice) {
  const std::size_t sums = dimension + lattice.plan.count_x + lattice.heights.size();
  const std::size_t by_y = lattice.plan.count_y / kLaneCount * kFieldRays * sizeof(LaneSums);
  return kFieldBytes / (sums * sizeof(RaySums) + by_y + sizeof(RayField));
}

std::size_t kept_place_boxes(std::size_t antennas, std::size_t dimension) {
  const std::size_t floats = PlaceBox::floats_of({kBoxRays, antennas, dimension / antennas});
  return kPlaceBoxBytes / (floats * sizeof(float) + sizeof(PlaceBox));
}

}  // namespace

FieldLattice places_of_box(const Grid& grid, double wavelength) {
  const Lattice closest = places_of_cell(grid, wavelength);
  const auto lanes = static_cast<double>(kLaneCount);
  FieldLattice places;
  places.plan.count_x = closest.count_x;
  places.plan.step_x = closest.step_x;
  // Slightly coarser than in x if whole rows would otherwise be half empty.
  const double rows = std::max(1.0, std::round(static_cast<double>(closest.count_y) / lanes));
  places.plan.count_y = static_cast<std::size_t>(rows * lanes);
  places.plan.step_y = grid.step_y / static_cast<double>(places.plan.count_y);
  for (const HeightSlice& slice : slices_of_box(grid, 0, wavelength)) {
    places.heights.push_back(slice.offset - grid.layers.offset.front());
  }
  return places;
}

std::vector<HeightSlice> slices_of_box(const Grid& grid, std::size_t layer, double wavelength) {
  return slices_of(
      grid.layers, layer, grid.height_sigma, NearbyLikelihood::kHeightDistance * wavelength);
}

struct AccessPointMap::Tracing {
  const Source source;
  const ReceiverTracer tracer;
  PathGrid rays;  // from each cell's centre

  std::vector<Ray> rays_to(const Vec3d& position) const {
    const DeviceModel& device = source.room->device;
    const Transmitter transmitter{{position, {}, device.pattern, device.polarization}};
    return rays_of(tracer.trace(transmitter), *source.room, position, kMaxRays);
  }

  Tracing(const Source& of, PathGridStore* store)
      : source(of),
        tracer(PathTracer(of.room->scene, of.room->trace)
                   .at(array_origin<Receiver>(of.room->access_points[of.access_point].array))) {
    const Grid& grid = source.grid;
    const RoomModel& room = *source.room;
    rays =
        make_path_grid({grid.size(), [&](std::size_t cell) { return rays_to(grid.centre(cell)); }},
                       path_grid_key(room, room.access_points[source.access_point], grid, kMaxRays),
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
      null_model_(likelihood_->null_model(access_point().error)),
      boxes_(std::make_unique<Kept<PlaceLikelihood>>(kMaxKeptBoxes)),
      close_boxes_(std::make_unique<Kept<PlaceLikelihood>>(kMaxKeptBoxes)),
      field_lattice_(places_of_box(source.grid, wavelength_of(*source.room))),
      covariances_(std::make_unique<Kept<FieldCovariance>>(kept_covariances(model_.dimension()))),
      fields_(std::make_unique<Kept<RayField>>(kept_fields(model_.dimension(), field_lattice_))),
      box_lattice_(source.grid),
      place_boxes_(
          std::make_unique<Kept<PlaceBox>>(kept_place_boxes(offsets_.size(), model_.dimension()))) {
  if (has_place_boxes()) {
    projection_ = std::make_unique<const MomentProjection>(
        source.room->grid, model_.basis(), offsets_.size());
  }
  traced_power_db_.resize(cells());
  for (std::size_t cell = 0; cell < cells(); ++cell) {
    if (is_reachable(cell)) {
      traced_power_db_[cell] = traced_power_db(tracing_->rays[cell], access_point().error);
    }
  }
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    without_.push_back(std::make_unique<Lazy<AccessPointMap>>());
  }
}

AccessPointMap::AccessPointMap(const Source& source, PathGridStore* store)
    : AccessPointMap(source,
                     std::make_shared<const Tracing>(source, store),
                     offsets_of(source.room->access_points[source.access_point].array)) {
  cells_.resize(cells());
  parallel_for(cells(), 16, [&](std::size_t cell) { cells_[cell] = make_place(cell); });
}

AccessPointMap::~AccessPointMap() = default;
AccessPointMap::AccessPointMap(AccessPointMap&&) noexcept = default;

const AccessPointMap& AccessPointMap::without(std::size_t antenna) const {
  RAYLOC_CHECK(antenna < offsets_.size() && offsets_.size() > 1);
  return without_[antenna]->get([&] {
    std::vector<Vec3d> left = offsets_;
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(antenna));
    std::unique_ptr<AccessPointMap> map(new AccessPointMap(source_, tracing_, std::move(left)));
    map->cells_on_use_ = std::vector<Lazy<PlaceLikelihood>>(cells());
    return map;
  });
}

const RoomAccessPoint& AccessPointMap::access_point() const {
  return source_.room->access_points[source_.access_point];
}

double AccessPointMap::cell_size() const {
  return std::sqrt(source_.grid.step_x * source_.grid.step_y);
}

bool AccessPointMap::is_reachable(std::size_t cell) const { return !tracing_->rays[cell].empty(); }

PlaceLikelihood AccessPointMap::make_place(std::size_t cell) const {
  const ModelError& error = access_point().error;
  if (source_.grid.layers.is_known() || !is_reachable(cell)) {
    return likelihood_->place({tracing_->rays[cell], offsets_, cell_size()}, error);
  }
  const std::vector<HeightSlice> coarse = coarsened(source_.grid.layers, kMaxInColumn);
  std::vector<std::vector<Ray>> rays;
  std::vector<Likelihood::WeightedPlace> heights;
  rays.reserve(coarse.size());
  heights.reserve(coarse.size());
  const double thickness = source_.grid.layers.thickness *
                           static_cast<double>(source_.grid.layers.size()) /
                           static_cast<double>(coarse.size());
  for (const HeightSlice& slice : coarse) {
    rays.push_back(rays_at(cell, slice.offset));
    heights.push_back({{rays.back(), offsets_, cell_size(), 0.0, thickness}, slice.weight});
  }
  return likelihood_->column(heights, error);
}

const PlaceLikelihood& AccessPointMap::place(std::size_t cell) const {
  return cells_on_use_.empty() ? cells_[cell] : cells_on_use_[cell].get([&] {
    return std::make_unique<const PlaceLikelihood>(make_place(cell));
  });
}

// Rays from a device in the middle of a layer.
std::vector<Ray> AccessPointMap::rays_in(std::size_t cell, std::size_t layer) const {
  return rays_at_height(tracing_->rays[cell],
                        source_.grid.layers.offset[layer],
                        source_.room->device,
                        access_point().array);
}

double AccessPointMap::log_likelihood_in(std::size_t cell,
                                         std::size_t layer,
                                         const ObservedBurst& observed) const {
  const auto box = boxes_->get(cell * source_.grid.layers.size() + layer, [&] {
    const std::vector<Ray> rays = rays_in(cell, layer);
    const Likelihood::WeightedPlace whole{
        {rays, offsets_, cell_size(), 0.0, source_.grid.layers.thickness}, 1.0};
    return likelihood_->column({&whole, 1}, access_point().error);
  });
  return likelihood_->log_likelihood(*box, observed);
}

ObservedBurst AccessPointMap::observe(std::span<const std::complex<double>> h, double noise) const {
  ObservedBurst observed = likelihood_->observe(h);
  observed.array.noise = noise;
  return observed;
}

ObservedBurst AccessPointMap::observe_single(std::span<const std::complex<double>> h,
                                             double noise) const {
  RAYLOC_CHECK(has_place_boxes());
  ObservedBurst observed{projection_->observe(h), {}, 0.0F};
  observed.array.noise = noise;
  return observed;
}

Likelihood::Coarse AccessPointMap::coarse(std::size_t cell, const ObservedBurst& observed) const {
  return likelihood_->coarse(place(cell), observed);
}

void AccessPointMap::fetch(std::size_t cell) const {
  if (cell >= cells()) {
    return;
  }
  const PlaceLikelihood* made =
      cells_on_use_.empty() ? &cells_[cell] : cells_on_use_[cell].if_made();
  if (made != nullptr) {
    rayloc::fetch(made->model.whitener);
  }
}

double AccessPointMap::log_likelihood(std::size_t cell,
                                      const ObservedBurst& observed,
                                      std::uint8_t windows) const {
  return likelihood_->log_likelihood(place(cell), observed, windows);
}

std::vector<double> AccessPointMap::power_log_likelihood(const ReceivedPower& received) const {
  std::vector<double> result(cells());
  std::vector<double> reachable;
  for (std::size_t cell = 0; cell < cells(); ++cell) {
    if (is_reachable(cell)) {
      result[cell] = received.log_likelihood(traced_power_db_[cell]);
      reachable.push_back(result[cell]);
    }
  }
  if (reachable.empty()) {
    return result;
  }
  const double mean = log_mean_exp(reachable, 1.0);
  for (std::size_t cell = 0; cell < cells(); ++cell) {
    result[cell] -= is_reachable(cell) ? mean : 0.0;
  }
  return result;
}

double AccessPointMap::null_model(const ObservedBurst& observed) const {
  return likelihood_->log_likelihood(null_model_, observed);
}

std::unique_ptr<const BoxEvaluator> AccessPointMap::evaluator_at(
    std::size_t cell, std::size_t layer, const ObservedBurst& observed) const {
  auto evaluator = std::make_unique<BoxEvaluator>();
  const ModelError& error = access_point().error;
  const bool is_known = source_.grid.layers.is_known();
  if (!is_known) {
    evaluator->rays_ = rays_in(cell, layer);
  }
  const Likelihood::Place place{is_known ? tracing_->rays[cell] : evaluator->rays_,
                                offsets_,
                                cell_size(),
                                0.0,
                                is_known ? 0.0 : source_.grid.layers.thickness};
  evaluator->box_ = close_boxes_->get(cell * source_.grid.layers.size() + layer,
                                      [&] { return likelihood_->close(place, error); });
  evaluator->nearby_ = likelihood_->nearby(place, *evaluator->box_, error, observed);
  return evaluator->nearby_ == nullptr ? nullptr : std::move(evaluator);
}

std::vector<Ray> AccessPointMap::rays_at(std::size_t cell, double height) const {
  return rays_at_height(tracing_->rays[cell], height, source_.room->device, access_point().array);
}

// Place of a device within half the place distance of the centre.
ObservationModel::Place AccessPointMap::field_place(std::span<const Ray> rays) const {
  const double height =
      field_lattice_.heights.size() > 1 ? field_lattice_.heights[1] - field_lattice_.heights[0] : 0;
  return {rays,
          offsets_,
          std::sqrt(field_lattice_.plan.step_x * field_lattice_.plan.step_y),
          0.0,
          height};
}

std::shared_ptr<const FieldCovariance> AccessPointMap::field_covariance(std::size_t cell,
                                                                        std::size_t layer) const {
  const std::size_t count = source_.grid.layers.size();
  const std::size_t bands = band_of(count - 1) + 1;
  return covariances_->get(cell * bands + band_of(layer), [&] {
    const std::size_t first = band_of(layer) * kLayersOfBand;
    const std::size_t last = std::min(first + kLayersOfBand, count) - 1;
    const double middle =
        0.5 * (source_.grid.layers.offset[first] + source_.grid.layers.offset[last]);
    const std::vector<Ray> rays = rays_at(cell, middle);
    return rayloc::field_covariance(model_, field_place(rays), access_point().error);
  });
}

std::shared_ptr<const RayField> AccessPointMap::field(std::size_t cell,
                                                      std::size_t layer,
                                                      const FieldCovariance& covariance) const {
  return fields_->get(cell * source_.grid.layers.size() + layer, [&] {
    const std::vector<Ray> rays = rays_in(cell, layer);
    return ray_field(model_, covariance, field_place(rays), access_point().error, field_lattice_);
  });
}

bool AccessPointMap::has_place_boxes() const {
  return source_.likelihood == LikelihoodKind::kPartial && antennas() <= kMaxBoxAntennas &&
         dimension() <= kMaxBoxDimension && access_point().error.noise > 0.0;
}

std::shared_ptr<const PlaceBox> AccessPointMap::place_box(std::uint32_t box,
                                                          int noise_class) const {
  RAYLOC_CHECK(has_place_boxes() && box < box_lattice_.size() && noise_class >= 0 &&
               noise_class < kNoiseClasses);
  const std::size_t number =
      std::size_t{box} * kNoiseClasses + static_cast<std::size_t>(noise_class);
  return place_boxes_->get(number, [&] {
    const std::size_t cell = box_lattice_.cell(box);
    const Vec3d shift = box_lattice_.middle(box) - source_.grid.centre(cell);
    const std::vector<Ray> rays = rays_at(cell, shift.z);
    const double wavelength = wavelength_of(*source_.room);
    const double height =
        box_lattice_.is_height_known() ? 0.0 : NearbyLikelihood::kHeightDistance * wavelength;
    ModelError error = access_point().error;
    error.noise += noise_of_class(noise_class, error.noise);
    return rayloc::place_box(
        model_,
        {rays, offsets_, NearbyLikelihood::kPlaceDistance * wavelength, 0.0, height},
        error,
        {shift, box_lattice_.half()});
  });
}

std::pair<FieldTerms, std::shared_ptr<const RayField>> FieldScan::at(std::size_t layer) {
  if (!burst_ || AccessPointMap::band_of(layer) != band_) {
    band_ = AccessPointMap::band_of(layer);
    covariance_ = map_.field_covariance(cell_, layer);
    burst_.emplace(
        *covariance_, observed_.array, map_.access_point().error.noise + observed_.array.noise);
  }
  auto field = map_.field(cell_, layer, *covariance_);
  FieldTerms terms = burst_->terms(*field);
  return {terms, std::move(field)};
}

std::vector<Ray> AccessPointMap::rays_to(const Vec3d& position) const {
  return tracing_->rays_to(position);
}

PlaceModel AccessPointMap::model_of(std::span<const Ray> rays, double survey_sigma) const {
  return model_.place({rays, offsets_, 0.0, survey_sigma}, access_point().error);
}

std::optional<double> AccessPointMap::obstructed_log_odds(std::span<const Ray> rays,
                                                          const ObservedBurst& observed) const {
  return rays.empty() || source_.likelihood != LikelihoodKind::kPartial
             ? std::nullopt
             : ObservationModel::obstructed_log_odds(
                   model_.place_of_burst(
                       {rays, offsets_, 0.0}, access_point().error, observed.array),
                   observed.array);
}

std::vector<std::complex<double>> AccessPointMap::expected(std::span<const Ray> rays) const {
  return model_.expected({rays, offsets_, 0.0}, access_point().error);
}

}  // namespace rayloc
