#include "engine/paper/person_localizer.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/paper/listen.h"
#include "engine/paper/person_loss.h"
#include "engine/paper/search.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc::paper {

class PersonLocalizer::Impl {
 public:
  Impl(std::shared_ptr<const RoomModel> room,
       const TargetBody& body,
       const LocalizerOptions& options)
      : room_(std::move(room)),
        options_(options),
        bounds_(plan_bounds(*room_, std::max(body.semi_axes[0], body.semi_axes[1]))),
        csi_loss_(room_->grid, options.csi) {}

  Expected<void> add(const PersonReference& reference, const PersonLink& link);
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t seed) const;
  std::optional<LossInPlan> loss(std::span<const CsiFrame> frames, const Vec3d& position) const;
  std::uint64_t seed() const { return options_.seed; }

 private:
  std::vector<PersonMeasurement> listen(std::span<const CsiFrame> frames,
                                        LocationEstimate& estimate) const {
    return paper::listen<PersonMeasurement>(
        *room_, links_, frames, options_.burst, csi_loss_, estimate);
  }
  PersonLoss loss_of(std::span<const PersonMeasurement> measured) const {
    return {*room_, csi_loss_, measured, options_.centre_weight};
  }

  std::shared_ptr<const RoomModel> room_;
  LocalizerOptions options_;
  PlanBounds bounds_;
  CsiLoss csi_loss_;
  std::vector<UsableLink> links_;
  std::vector<std::string> warnings_;
};

Expected<void> PersonLocalizer::Impl::add(const PersonReference& reference,
                                          const PersonLink& link) {
  RAYLOC_TRY(check_link(*room_, link));
  const RoomAccessPoint& ap = room_->access_points[link.access_point];
  if (ap.rx_chains.size() < 2) {
    warnings_.push_back("access point " + ap.id +
                        " has a single antenna, and there is no ratio of one");
    return {};
  }
  auto scattering = PersonScattering::create(
      *room_, link.access_point, reference.transmitter, reference.person.body, kPersonDepth);
  RAYLOC_TRY(scattering);
  links_.push_back({link.access_point, *std::move(scattering), link.empty, link.scale});
  return {};
}

LocationEstimate PersonLocalizer::Impl::locate(std::span<const CsiFrame> frames,
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
    estimate.reason = no_usable_reference_csi(estimate.warnings);
    return estimate;
  }
  const PersonLoss loss = loss_of(measured);
  const End best = search([&loss](const Vec3d& position) { return loss.at(position); },
                          {bounds_, room_->bounds_min.z, seed, frames.front().time},
                          options_);
  estimate.loss = best.loss;
  estimate.iterations = static_cast<std::size_t>(options_.descent.iterations);
  estimate.starts = options_.starts;
  estimate.position = best.position;
  estimate.model_residual_db = loss.model_residual_db(best.position);
  return estimate;
}

std::optional<LossInPlan> PersonLocalizer::Impl::loss(std::span<const CsiFrame> frames,
                                                      const Vec3d& position) const {
  LocationEstimate unused;
  const auto measured = frames.empty() ? std::vector<PersonMeasurement>() : listen(frames, unused);
  if (measured.empty()) {
    return std::nullopt;
  }
  return loss_of(measured).at(position);
}

Expected<PersonLocalizer> PersonLocalizer::create(std::shared_ptr<const RoomModel> room,
                                                  const PersonReference& reference,
                                                  const LocalizerOptions& options) {
  RAYLOC_TRY(validate(options));
  RAYLOC_TRY(check_room(room.get()));
  if (reference.links.empty()) {
    return make_error(ErrorKind::kConfiguration, "the reference is of no access point");
  }
  auto impl = std::make_unique<Impl>(std::move(room), reference.person.body, options);
  for (const PersonLink& link : reference.links) {
    RAYLOC_TRY(impl->add(reference, link));
  }
  return PersonLocalizer(std::move(impl));
}

PersonLocalizer::PersonLocalizer(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
PersonLocalizer::~PersonLocalizer() = default;
PersonLocalizer::PersonLocalizer(PersonLocalizer&&) noexcept = default;
PersonLocalizer& PersonLocalizer::operator=(PersonLocalizer&&) noexcept = default;

LocationEstimate PersonLocalizer::locate(std::span<const CsiFrame> frames) const {
  return impl_->locate(frames, impl_->seed());
}
LocationEstimate PersonLocalizer::locate(std::span<const CsiFrame> frames,
                                         std::uint64_t seed) const {
  return impl_->locate(frames, seed);
}
std::optional<LossInPlan> PersonLocalizer::loss(std::span<const CsiFrame> frames,
                                                const Vec3d& position) const {
  return impl_->loss(frames, position);
}

}  // namespace rayloc::paper
