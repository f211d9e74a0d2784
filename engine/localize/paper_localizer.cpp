#include "engine/localize/paper_localizer.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/localize/hearing.h"
#include "engine/localize/paper_position_loss.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

// The device is in the air of the room: on a wall's face itself no path begins.
constexpr double kMargin = 0.01;  // [m]

Expected<void> check(const PaperLocalizerOptions& options) {
  const auto refuse = [](const char* what) { return make_error(ErrorKind::kUsage, what); };
  const auto is_weight = [](double x) { return x >= 0.0 && std::isfinite(x); };
  if (!is_weight(options.csi.delay_weight) || !is_weight(options.centre_weight)) {
    return refuse("the weights of the paper's loss are 0 or more");
  }
  if (!(options.csi.floor > 0.0) || !std::isfinite(options.csi.floor)) {
    return refuse("the floor of the paper's loss is more than 0");
  }
  if (options.starts == 0) {
    return refuse("the paper's method takes 1 or more starts");
  }
  if (auto valid = validate(options.descent); !valid) {
    return valid;
  }
  return validate(options.csi.smoothing);
}

PlanBounds bounds_of(const RoomModel& room) {
  const auto inside = [](double least, double most) {
    const double margin = std::min(kMargin, 0.5 * (most - least));
    return std::pair(least + margin, most - margin);
  };
  const auto [min_x, max_x] = inside(room.bounds_min.x, room.bounds_max.x);
  const auto [min_y, max_y] = inside(room.bounds_min.y, room.bounds_max.y);
  return {{min_x, min_y, room.bounds_min.z}, {max_x, max_y, room.bounds_max.z}};
}

std::mt19937_64 random_of(std::uint64_t seed, Timestamp time, std::size_t start) {
  const auto ticks = static_cast<std::uint64_t>(time.time_since_epoch().count());
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); };
  std::seed_seq seeds{low(seed), high(seed), low(ticks), high(ticks), low(start), high(start)};
  return std::mt19937_64(seeds);
}

}  // namespace

class PaperLocalizer::Impl {
 public:
  Impl(std::shared_ptr<const RoomModel> room, const PaperLocalizerOptions& options)
      : room_(std::move(room)),
        options_(options),
        bounds_(bounds_of(*room_)),
        csi_loss_(room_->grid, options.csi) {
    const PathTracer tracer(room_->scene, room_->trace);
    for (std::size_t i = 0; i < room_->access_points.size(); ++i) {
      const RoomAccessPoint& ap = room_->access_points[i];
      std::string problem = calibration_problem(*room_, ap);
      if (problem.empty() && ap.cores.size() < 2) {
        problem = "has a single antenna, and there is no ratio of one";
      }
      if (problem.empty()) {
        stations_.push_back({i, ArrayTracer(tracer, ap.array)});
      } else {
        warnings_.push_back("access point " + ap.id + " " + problem);
      }
    }
  }

  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t seed) const;
  std::optional<LossInPlan> loss(std::span<const CsiFrame> frames, const Vec3d& position) const;
  const RoomModel& room() const { return *room_; }
  std::uint64_t seed() const { return options_.seed; }

 private:
  struct End {
    Vec3d position;
    double loss = 0.0;
  };

  std::vector<PaperMeasurement> listen(std::span<const CsiFrame> frames,
                                       LocationEstimate& estimate) const;
  PaperPositionLoss loss_of(std::span<const PaperMeasurement> measured) const {
    return {*room_, csi_loss_, measured, options_.centre_weight};
  }
  End run(const PaperPositionLoss& loss, std::mt19937_64 random, std::size_t start) const;

  std::shared_ptr<const RoomModel> room_;
  PaperLocalizerOptions options_;
  PlanBounds bounds_;
  PaperCsiLoss csi_loss_;
  std::vector<PaperStation> stations_;
  std::vector<std::string> warnings_;
};

std::vector<PaperMeasurement> PaperLocalizer::Impl::listen(std::span<const CsiFrame> frames,
                                                           LocationEstimate& estimate) const {
  std::vector<PaperMeasurement> measured;
  HearingTally tally;
  for (const PaperStation& station : stations_) {
    auto burst = hear(*room_, station.access_point, frames, options_.burst, estimate.warnings);
    if (burst) {
      tally.add(room_->access_points[station.access_point], *burst);
      auto observables = csi_loss_.observe(burst->h);
      measured.push_back({&station, std::move(burst->h), std::move(observables)});
    }
  }
  tally.fill(frames, estimate);
  return measured;
}

PaperLocalizer::Impl::End PaperLocalizer::Impl::run(const PaperPositionLoss& loss,
                                                    std::mt19937_64 random,
                                                    std::size_t start) const {
  std::uniform_real_distribution<double> along_x(bounds_.min.x, bounds_.max.x);
  std::uniform_real_distribution<double> along_y(bounds_.min.y, bounds_.max.y);
  const double x = along_x(random);
  const double y = along_y(random);
  Vec3d from{x, y, room_->device.height};
  if (start == 0 && options_.start) {
    from = {options_.start->x, options_.start->y, room_->device.height};
  }
  const auto at = [&loss](const Vec3d& position) { return loss.at(position); };
  const Vec3d end = descend(at, from, bounds_, options_.descent, random).position;
  return {end, loss.at(end).value};
}

LocationEstimate PaperLocalizer::Impl::locate(std::span<const CsiFrame> frames,
                                              std::uint64_t seed) const {
  LocationEstimate estimate;
  estimate.warnings = warnings_;
  estimate.is_uncertainty_stated = false;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return estimate;
  }
  const auto measured = listen(frames, estimate);
  if (measured.empty()) {
    estimate.reason = estimate.warnings.empty() ? "no access point of the site heard the burst"
                                                : estimate.warnings.front();
    return estimate;
  }
  const PaperPositionLoss loss = loss_of(measured);
  std::vector<End> ends(options_.starts);
  parallel_for(ends.size(), 1, [&](std::size_t i) {
    ends[i] = run(loss, random_of(seed, frames.front().time, i), i);
  });
  const End& best = *std::min_element(
      ends.begin(), ends.end(), [](const End& a, const End& b) { return a.loss < b.loss; });
  estimate.loss = best.loss;
  estimate.iterations = static_cast<std::size_t>(options_.descent.iterations);
  estimate.starts = ends.size();
  if (!loss.is_reached(best.position)) {
    estimate.reason = "the descent ended where no path leads to any access point";
    return estimate;
  }
  estimate.position = best.position;
  estimate.model_residual_db = loss.model_residual_db(best.position);
  return estimate;
}

std::optional<LossInPlan> PaperLocalizer::Impl::loss(std::span<const CsiFrame> frames,
                                                     const Vec3d& position) const {
  LocationEstimate unused;
  const auto measured = frames.empty() ? std::vector<PaperMeasurement>() : listen(frames, unused);
  if (measured.empty()) {
    return std::nullopt;
  }
  return loss_of(measured).at(position);
}

Expected<PaperLocalizer> PaperLocalizer::create(std::shared_ptr<const RoomModel> room,
                                                const PaperLocalizerOptions& options) {
  if (auto valid = check(options); !valid) {
    return tl::make_unexpected(std::move(valid.error()));
  }
  if (auto valid = check_room(room.get()); !valid) {
    return tl::make_unexpected(std::move(valid.error()));
  }
  return PaperLocalizer(std::make_unique<const Impl>(std::move(room), options));
}

PaperLocalizer::PaperLocalizer(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
PaperLocalizer::~PaperLocalizer() = default;
PaperLocalizer::PaperLocalizer(PaperLocalizer&&) noexcept = default;
PaperLocalizer& PaperLocalizer::operator=(PaperLocalizer&&) noexcept = default;

LocationEstimate PaperLocalizer::locate(std::span<const CsiFrame> frames) const {
  return impl_->locate(frames, impl_->seed());
}

LocationEstimate PaperLocalizer::locate(std::span<const CsiFrame> frames,
                                        std::uint64_t seed) const {
  return impl_->locate(frames, seed);
}

std::optional<LossInPlan> PaperLocalizer::loss(std::span<const CsiFrame> frames,
                                               const Vec3d& position) const {
  return impl_->loss(frames, position);
}

const RoomModel& PaperLocalizer::room() const { return impl_->room(); }

}  // namespace rayloc
