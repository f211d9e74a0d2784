#include "engine/localize/localizer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/grid/height_layers.h"
#include "engine/likelihood/likelihood.h"
#include "engine/likelihood/received_power.h"
#include "engine/localize/access_point_map.h"
#include "engine/localize/fix_warnings.h"
#include "engine/localize/search_area.h"
#include "engine/localize/tracked_search.h"
#include "engine/observe/alignment.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/cell_places.h"
#include "engine/posterior/posterior.h"
#include "engine/posterior/room_map.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

// Cells whose coarse log-likelihood is this far below the best are not refined. The coarse search
// misses a delay by 3 ns at most, which costs about 10.
constexpr double kCoarseMargin = 35.0;
constexpr double kFarBelow = 1e4;  // [nat], chosen: penalty of such a cell, to give it no weight
// Share of the prior mass, chosen: with more outside the boxes of the tracked search, the choice of
// boxes would decide between peaks.
constexpr double kMaxUnevaluated = 0.1;
// Nearly all power of a burst from this room lies in the basis of delays; q / tones for noise.
constexpr double kMinCaptured = 0.5;
// A ratio, chosen: a perfect fit is -300 dB and not infinite.
constexpr double kMinResidual = 1e-30;

// Log-likelihoods of every access point and cell, relative to the null model.
struct AccessPointMaps {
  std::vector<double> null_model;         // [array], log-likelihood of the null model
  std::vector<std::vector<double>> cell;  // [array][cell]
};

}  // namespace

class Localizer::Impl {
 public:
  Impl(std::shared_ptr<const RoomModel> room, LocalizerOptions options)
      : room_(std::move(room)), options_(std::move(options)), area_(search_area(*room_)) {
    options_.burst.leaves_out_absent = true;
    if (compares_antennas(options_.likelihood)) {  // at the assumed height
      area_.grid.height_sigma = 0.0;
    }
    area_.grid.layers = height_layers(
        {room_->device.height, grid_.height_sigma}, room_->bounds_min.z, room_->bounds_max.z);
  }

  void build() {
    for (std::size_t i = 0; i < room_->access_points.size(); ++i) {
      const RoomAccessPoint& ap = room_->access_points[i];
      std::string problem = calibration_problem(*room_, ap);
      if (problem.empty() && ap.rx_chains.size() < least_antennas()) {
        problem = "has a single antenna, and there is no ratio of one";
      }
      if (!problem.empty()) {
        warnings_.push_back("access point " + ap.id + " " + problem);
        continue;
      }
      index_.push_back(i);
      aps_.push_back(std::make_unique<const AccessPointMap>(
          AccessPointMap::Source{room_, i, grid_, options_.likelihood}, options_.path_grids.get()));
    }
  }

  RoomObservation receive(std::span<const CsiFrame> frames, Precision precision) const;
  Evidence evidence(const RoomObservation& observation, Scan scan, const SearchFocus& focus) const;
  LocationEstimate locate(std::span<const CsiFrame> frames,
                          double likelihood_exponent,
                          double fault) const;
  bool has_place_boxes() const {
    return std::all_of(
        aps_.begin(), aps_.end(), [](const auto& one) { return one->has_place_boxes(); });
  }
  const RoomModel& room() const { return *room_; }
  const SearchArea& area() const { return area_; }
  const Grid& grid() const { return grid_; }
  const LocalizerOptions& options() const { return options_; }

 private:
  std::size_t least_antennas() const { return compares_antennas(options_.likelihood) ? 2 : 1; }

  std::vector<ArrayObservation> arrays_of(std::span<const CsiFrame> frames,
                                          Precision precision,
                                          LocationEstimate& estimate) const;
  std::optional<ArrayObservation> received_by(std::size_t number,
                                              BurstObservation& burst,
                                              Precision precision,
                                              LocationEstimate& estimate) const;
  AccessPointMaps maps_of(const std::vector<ArrayObservation>& received,
                          double likelihood_exponent,
                          double far_below,
                          const CellSet& compared) const;
  Evidence finished(RoomMap map, const AccessPointFusion& fusion, const CellSet& compared) const;
  Evidence tracked_evidence(TrackedSearch& search,
                            std::vector<ArrayObservation> received,
                            const SearchFocus& focus) const;
  TrackedSearch::Room search_room() const {
    return {grid_, kSpeedOfLight / room_->grid.centre_hz, room_->likelihood_exponent};
  }
  LocalRefinement local_refinement(const std::vector<ArrayObservation>& received,
                                   const AccessPointMaps& maps,
                                   const AccessPointFusion& fusion,
                                   double likelihood_exponent,
                                   const SearchFocus& focus,
                                   const CellSet& compared) const;
  void keep_explained(std::vector<ArrayObservation>& received,
                      AccessPointMaps& maps,
                      LocationEstimate& estimate) const;
  double model_residual(const std::vector<ArrayObservation>& received,
                        const RaysOfEach& rays) const;

  std::shared_ptr<const RoomModel> room_;
  LocalizerOptions options_;
  SearchArea area_;
  const Grid& grid_ = area_.grid;
  std::vector<std::unique_ptr<const AccessPointMap>> aps_;
  std::vector<std::size_t> index_;  // [access point], index in RoomModel::access_points
  std::vector<std::string> warnings_;
};

// Array of a burst that is a possible channel of this room. Excludes a dead chain.
std::optional<ArrayObservation> Localizer::Impl::received_by(std::size_t number,
                                                             BurstObservation& burst,
                                                             Precision precision,
                                                             LocationEstimate& estimate) const {
  const AccessPointMap* map = aps_[number].get();
  const RoomAccessPoint& ap = map->access_point();
  if (const auto dead = dead_chain(burst)) {
    estimate.warnings.push_back(dead_chain_text(ap, burst, *dead) + "; it is left out");
    if (map->antennas() <= least_antennas()) {
      return std::nullopt;
    }
    burst = without_row(std::move(burst), dead->row);
    map = &map->without(dead->row);
  }
  const double noise = burst.noise_variance * static_cast<double>(map->dimension()) /
                       static_cast<double>(burst.h.size());
  const bool is_single = precision == Precision::kSingle && map->has_place_boxes();
  ArrayObservation received{
      number,
      map,
      is_single ? map->observe_single(burst.h, noise) : map->observe(burst.h, noise),
      burst.h,
      {}};
  if (received.observed.array.captured < kMinCaptured) {
    estimate.warnings.push_back("access point " + ap.id +
                                ": its CSI does not match any channel this room can produce");
    return std::nullopt;
  }
  if (const auto power = received_power(ap, burst)) {
    received.power_log_likelihood = map->power_log_likelihood(*power);
  }
  return received;
}

std::vector<ArrayObservation> Localizer::Impl::arrays_of(std::span<const CsiFrame> frames,
                                                         Precision precision,
                                                         LocationEstimate& estimate) const {
  std::vector<ArrayObservation> received;
  BurstOptions options = options_.burst;
  options.aligns_single_frame = precision == Precision::kDouble;
  ObservationTally tally;
  for (std::size_t number = 0; number < aps_.size(); ++number) {
    auto burst = preprocess_burst(*room_, index_[number], frames, options, estimate.warnings);
    auto one = burst ? received_by(number, *burst, precision, estimate) : std::nullopt;
    if (one) {
      tally.add(aps_[number]->access_point(), *burst);
      received.push_back(*std::move(one));
    }
  }
  tally.fill(frames, estimate);
  return received;
}

// Refines cells near the joint best of all access points and near the best of each one; far_below
// is subtracted for the others.
AccessPointMaps Localizer::Impl::maps_of(const std::vector<ArrayObservation>& received,
                                         double likelihood_exponent,
                                         double far_below,
                                         const CellSet& compared) const {
  const std::size_t count = compared.size(grid_);
  AccessPointMaps maps;
  for (const ArrayObservation& one : received) {
    maps.null_model.push_back(one.map->null_model(one.observed));
  }
  maps.cell.assign(received.size(), std::vector<double>(count));
  std::vector<std::vector<std::uint8_t>> windows(received.size(), std::vector<std::uint8_t>(count));
  std::vector<double> sum(count);
  const auto above = [&](std::size_t i, std::size_t cell, double log_likelihood) {
    return log_likelihood - maps.null_model[i] +
           received[i].power_log_likelihood_at(cell, likelihood_exponent);
  };
  parallel_for(count, 64, [&](std::size_t n) {
    const std::size_t cell = compared.cell(n);
    for (std::size_t i = 0; i < received.size(); ++i) {
      const AccessPointMap& ap = *received[i].map;
      if (n + 1 < count) {
        ap.fetch(compared.cell(n + 1));
      }
      if (ap.is_reachable(cell)) {
        const auto coarse = ap.coarse(cell, received[i].observed);
        windows[i][n] = coarse.windows;
        maps.cell[i][n] = above(i, cell, coarse.log_likelihood);
      }
      sum[n] += maps.cell[i][n];
    }
  });
  const double least = *std::max_element(sum.begin(), sum.end()) - kCoarseMargin;
  std::vector<double> least_of_one;
  for (const std::vector<double>& one : maps.cell) {
    least_of_one.push_back(*std::max_element(one.begin(), one.end()) - kCoarseMargin);
  }
  parallel_for(count, 64, [&](std::size_t n) {
    const std::size_t cell = compared.cell(n);
    for (std::size_t i = 0; i < received.size(); ++i) {
      if (n + 1 < count && sum[n + 1] >= least) {
        received[i].map->fetch(compared.cell(n + 1));
      }
      double& value = maps.cell[i][n];
      if (sum[n] < least && value < least_of_one[i]) {
        value -= far_below;
      } else if (received[i].map->is_reachable(cell)) {
        const double fine =
            received[i].map->log_likelihood(cell, received[i].observed, windows[i][n]);
        value = above(i, cell, fine);
      }
    }
  });
  return maps;
}

LocalRefinement Localizer::Impl::local_refinement(const std::vector<ArrayObservation>& received,
                                                  const AccessPointMaps& maps,
                                                  const AccessPointFusion& fusion,
                                                  double likelihood_exponent,
                                                  const SearchFocus& focus,
                                                  const CellSet& compared) const {
  return {grid_,
          kSpeedOfLight / room_->grid.centre_hz,
          received,
          maps.null_model,
          fusion,
          likelihood_exponent,
          focus,
          compared};
}

double Localizer::Impl::model_residual(const std::vector<ArrayObservation>& received,
                                       const RaysOfEach& rays) const {
  double residual = 0.0;
  const Aligner aligner(room_->grid);
  for (std::size_t i = 0; i < received.size(); ++i) {
    residual += 1.0 - aligner.align(received[i].map->expected(rays[i]), received[i].h).correlation;
  }
  return 10.0 * std::log10(std::max(residual / static_cast<double>(received.size()), kMinResidual));
}

RoomObservation Localizer::Impl::receive(std::span<const CsiFrame> frames,
                                         Precision precision) const {
  RoomObservation observation;
  LocationEstimate& estimate = observation.estimate;
  estimate.warnings = warnings_;
  estimate.accuracy_confidence = options_.accuracy_confidence;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return observation;
  }
  observation.arrays = arrays_of(frames, precision, estimate);
  if (observation.arrays.empty()) {
    estimate.reason = no_usable_csi(*room_, estimate.warnings);
  }
  return observation;
}

// Removes arrays that no place explains; the result is empty if no access point is explained.
void Localizer::Impl::keep_explained(std::vector<ArrayObservation>& received,
                                     AccessPointMaps& maps,
                                     LocationEstimate& estimate) const {
  for (std::size_t i = received.size(); i-- > 0;) {
    const double best = *std::max_element(maps.cell[i].begin(), maps.cell[i].end());
    if (best > 0.0) {
      continue;
    }
    estimate.reason = "no place of the room explains the burst better than diffuse scattering";
    estimate.loss = -best;
    estimate.warnings.push_back("access point " + received[i].map->access_point().id + ": " +
                                estimate.reason);
    const auto at = static_cast<std::ptrdiff_t>(i);
    received.erase(received.begin() + at);
    maps.cell.erase(maps.cell.begin() + at);
    maps.null_model.erase(maps.null_model.begin() + at);
  }
}

LocationEstimate Localizer::Impl::locate(std::span<const CsiFrame> frames,
                                         double likelihood_exponent,
                                         double fault) const {
  RoomObservation observation = receive(frames, Precision::kDouble);
  LocationEstimate& estimate = observation.estimate;
  if (observation.arrays.empty()) {
    return std::move(estimate);
  }
  const SearchFocus anywhere;
  const CellSet compared = compared_cells(grid_, anywhere);
  AccessPointMaps maps = maps_of(observation.arrays, likelihood_exponent, kFarBelow, compared);
  keep_explained(observation.arrays, maps, estimate);
  if (observation.arrays.empty()) {
    return std::move(estimate);
  }
  estimate.reason.clear();
  const std::vector<double> faulty(observation.arrays.size(), options_.faults.access_point);
  const AccessPointFusion fusion(maps.cell, likelihood_exponent, faulty);
  RoomMap map = fuse(maps.cell, fusion);
  refine_locally(
      local_refinement(observation.arrays, maps, fusion, likelihood_exponent, anywhere, compared),
      map);
  const double contradicted = fusion.outlier(log_mean_exp(map.log_likelihood, likelihood_exponent),
                                             options_.faults.outlier);
  const double outside = take_outside(area_, likelihood_exponent, map.log_likelihood);
  const double outlier = 1.0 - (1.0 - contradicted) * (1.0 - outside);
  if (outlier > SearchArea::kMaxOutlierShare) {
    estimate.reason =
        outside > contradicted
            ? SearchArea::kBeside
            : "the access points contradict each other: the device is not in the area, or more "
              "than one of them has changed";
    return std::move(estimate);
  }
  summarise_posterior(grid_,
                      map.log_likelihood,
                      {likelihood_exponent,
                       options_.accuracy_confidence,
                       options_.max_hypotheses,
                       1.0 - (1.0 - outlier) * (1.0 - fault),
                       room_->sigma_floor},
                      estimate,
                      map.within);
  if (estimate.position) {
    RaysOfEach rays;
    for (const ArrayObservation& one : observation.arrays) {
      rays.push_back(one.map->rays_to(*estimate.position));
    }
    warn_of_suspects(observation.arrays, map, likelihood_exponent, rays, estimate);
    estimate.model_residual_db = model_residual(observation.arrays, rays);
  }
  return std::move(estimate);
}

Localizer::Evidence Localizer::Impl::evidence(const RoomObservation& observation,
                                              Scan scan,
                                              const SearchFocus& focus) const {
  std::vector<ArrayObservation> received = observation.arrays;
  if (scan == Scan::kPlaces && !focus.cells.empty() && received.front().map->has_fields()) {
    TrackedSearch search(search_room(), received, focus);
    if (search.unevaluated_mass() < kMaxUnevaluated) {
      return tracked_evidence(search, std::move(received), focus);
    }
  }
  const double likelihood_exponent = room_->likelihood_exponent;
  const CellSet compared = compared_cells(grid_, focus);
  AccessPointMaps maps = maps_of(received, likelihood_exponent, 0.0, compared);
  LocationEstimate unused;
  keep_explained(received, maps, unused);
  if (received.empty()) {
    return {};
  }
  const std::vector<double> faulty(received.size(), options_.faults.access_point);
  const AccessPointFusion fusion(maps.cell, likelihood_exponent, faulty, compared.weights);
  RoomMap map = fuse(maps.cell, fusion);
  const bool is_quick =  // a single height has few places
      focus.is_quick && focus.cells.empty() && !grid_.layers.is_known() &&
      received.front().map->has_fields();
  if (scan == Scan::kPlaces && is_quick) {
    search_best_boxes(search_room(), received, maps.null_model, fusion, focus, map);
  } else if (scan == Scan::kPlaces) {
    refine_locally(local_refinement(received, maps, fusion, likelihood_exponent, focus, compared),
                   map);
  }
  return finished(std::move(map), fusion, compared);
}

// Evidence for a device with a known approximate position.
Localizer::Evidence Localizer::Impl::tracked_evidence(TrackedSearch& search,
                                                      std::vector<ArrayObservation> received,
                                                      const SearchFocus& focus) const {
  const double exponent = room_->likelihood_exponent;
  SearchFocus searched;
  searched.cells = search.cells();
  searched.others = focus.others;
  const CellSet compared = compared_cells(grid_, searched);
  AccessPointMaps maps = maps_of(received, exponent, 0.0, CellSet{focus.others, {}});
  const auto close = search.scan(maps.null_model);
  for (std::size_t i = 0; i < received.size(); ++i) {
    maps.cell[i].insert(maps.cell[i].begin(), close[i].begin(), close[i].end());
    if (*std::max_element(maps.cell[i].begin(), maps.cell[i].end()) <= 0.0) {
      maps.cell[i].clear();
    }
  }
  for (std::size_t i = received.size(); i-- > 0;) {
    if (maps.cell[i].empty()) {
      search.leave_out(i);
      const auto at = static_cast<std::ptrdiff_t>(i);
      received.erase(received.begin() + at);
      maps.cell.erase(maps.cell.begin() + at);
    }
  }
  if (received.empty()) {
    return {};
  }
  const std::vector<double> faulty(received.size(), options_.faults.access_point);
  const AccessPointFusion fusion(maps.cell, exponent, faulty, compared.weights);
  RoomMap map = fuse(maps.cell, fusion);
  search.put_together(fusion, map);
  return finished(std::move(map), fusion, compared);
}

// Adds the probability of a device outside the area or an uninformative burst.
Localizer::Evidence Localizer::Impl::finished(RoomMap map,
                                              const AccessPointFusion& fusion,
                                              const CellSet& compared) const {
  const double exponent = room_->likelihood_exponent;
  Evidence result;
  result.within = std::move(map.within);
  result.log_likelihood = std::move(map.log_likelihood);
  const double contradicted = fusion.outlier(
      log_mean_exp(result.log_likelihood, exponent, compared.weights), options_.faults.outlier);
  const double outside = take_outside(area_, exponent, result.log_likelihood, compared);
  result.evaluated = compared;
  result.outlier = 1.0 - (1.0 - contradicted) * (1.0 - outside);
  return result;
}

Expected<Localizer> Localizer::create(std::shared_ptr<const RoomModel> room,
                                      const LocalizerOptions& options) {
  RAYLOC_TRY(check_room(room.get()));
  auto impl = std::make_unique<Impl>(std::move(room), options);
  impl->build();
  return Localizer(std::move(impl));
}

Localizer::Localizer(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

LocationEstimate Localizer::locate(std::span<const CsiFrame> frames,
                                   const FrameFault& fault) const {
  return impl_->locate(frames, impl_->room().likelihood_exponent, fault.probability);
}
LocationEstimate Localizer::locate(std::span<const CsiFrame> frames,
                                   double likelihood_exponent) const {
  return impl_->locate(frames, likelihood_exponent, 0.0);
}

RoomObservation Localizer::receive(std::span<const CsiFrame> frames, Precision precision) const {
  return impl_->receive(frames, precision);
}
Localizer::Evidence Localizer::evidence(const RoomObservation& observation,
                                        Scan scan,
                                        const SearchFocus& focus) const {
  RAYLOC_CHECK(!observation.arrays.empty());
  return impl_->evidence(observation, scan, focus);
}

bool Localizer::has_place_boxes() const { return impl_->has_place_boxes(); }
const SearchArea& Localizer::area() const { return impl_->area(); }
const Grid& Localizer::grid() const { return impl_->grid(); }
const RoomModel& Localizer::room() const { return impl_->room(); }
const LocalizerOptions& Localizer::options() const { return impl_->options(); }

}  // namespace rayloc
