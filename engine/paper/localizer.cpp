#include "engine/paper/localizer.h"

#include <string>
#include <utility>
#include <vector>

#include "engine/paper/listen.h"
#include "engine/paper/position_loss.h"
#include "engine/paper/search.h"
#include "engine/room/preprocess_burst.h"
#include "engine/trace/path_tracer.h"

namespace rayloc::paper {
namespace {

// The device must be in the air of the room: no path starts on the face of a wall.
constexpr double kMargin = 0.01;  // [m]

}  // namespace

class Localizer::Impl {
 public:
  Impl(std::shared_ptr<const RoomModel> room, const LocalizerOptions& options)
      : room_(std::move(room)),
        options_(options),
        bounds_(plan_bounds(*room_, kMargin)),
        csi_loss_(room_->grid, options.csi) {
    const PathTracer tracer(room_->scene, room_->trace);
    for (std::size_t i = 0; i < room_->access_points.size(); ++i) {
      const RoomAccessPoint& ap = room_->access_points[i];
      std::string problem = calibration_problem(*room_, ap);
      if (problem.empty() && ap.rx_chains.size() < 2) {
        problem = "has a single antenna, and there is no ratio of one";
      }
      if (problem.empty()) {
        aps_.push_back({i, ArrayTracer(tracer, ap.array)});
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
  std::vector<Measurement> listen(std::span<const CsiFrame> frames,
                                  LocationEstimate& estimate) const {
    return paper::listen<Measurement>(*room_, aps_, frames, options_.burst, csi_loss_, estimate);
  }
  PositionLoss loss_of(std::span<const Measurement> measured) const {
    return {*room_, csi_loss_, measured, options_.centre_weight};
  }

  std::shared_ptr<const RoomModel> room_;
  LocalizerOptions options_;
  PlanBounds bounds_;
  CsiLoss csi_loss_;
  std::vector<UsableAccessPoint> aps_;
  std::vector<std::string> warnings_;
};

LocationEstimate Localizer::Impl::locate(std::span<const CsiFrame> frames,
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
    estimate.reason = no_usable_csi(*room_, estimate.warnings);
    return estimate;
  }
  const PositionLoss loss = loss_of(measured);
  const End best = search([&loss](const Vec3d& position) { return loss.at(position); },
                          {bounds_, room_->device.height, seed, frames.front().time},
                          options_);
  estimate.loss = best.loss;
  estimate.iterations = static_cast<std::size_t>(options_.descent.iterations);
  estimate.starts = options_.starts;
  if (!loss.is_reached(best.position)) {
    estimate.reason = "the descent ended where no path leads to any access point";
    return estimate;
  }
  estimate.position = best.position;
  estimate.model_residual_db = loss.model_residual_db(best.position);
  return estimate;
}

std::optional<LossInPlan> Localizer::Impl::loss(std::span<const CsiFrame> frames,
                                                const Vec3d& position) const {
  LocationEstimate unused;
  const auto measured = frames.empty() ? std::vector<Measurement>() : listen(frames, unused);
  if (measured.empty()) {
    return std::nullopt;
  }
  return loss_of(measured).at(position);
}

Expected<Localizer> Localizer::create(std::shared_ptr<const RoomModel> room,
                                      const LocalizerOptions& options) {
  RAYLOC_TRY(validate(options));
  RAYLOC_TRY(check_room(room.get()));
  return Localizer(std::make_unique<const Impl>(std::move(room), options));
}

Localizer::Localizer(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Localizer::~Localizer() = default;
Localizer::Localizer(Localizer&&) noexcept = default;
Localizer& Localizer::operator=(Localizer&&) noexcept = default;

LocationEstimate Localizer::locate(std::span<const CsiFrame> frames) const {
  return impl_->locate(frames, impl_->seed());
}

LocationEstimate Localizer::locate(std::span<const CsiFrame> frames, std::uint64_t seed) const {
  return impl_->locate(frames, seed);
}

std::optional<LossInPlan> Localizer::loss(std::span<const CsiFrame> frames,
                                          const Vec3d& position) const {
  return impl_->loss(frames, position);
}

const RoomModel& Localizer::room() const { return impl_->room(); }

}  // namespace rayloc::paper
