// Localizer: the published method of device-based localization (METHODS A4), unchanged: a loss
// of the smoothed ratio amplitudes and the delay spreads, minimised from a random start.
//
//   L(P) = mean over access points of (MSE(a) + gamma_1 MSE(tau)) + gamma_2 |xy - c|^2
//
// with CsiLoss for the first two terms, c the middle of the room (METHODS C4) and search() as
// the descent; the height is that of the room's device. The gradient is the tracer's. Paths are
// those of RoomModel::trace with its surface corrections.
//
// The result is one position. The method gives no uncertainty: the last width of its smoothing
// follows from the schedule, not from the measurement. So the estimate has no covariance, accuracy
// or hypotheses (LocationEstimate::is_uncertainty_stated is false), and all of the probability is
// "somewhere else".
//
// Starts and random numbers: see Search.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/paper/descent.h"
#include "engine/paper/options.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc::paper {

class Localizer {
 public:
  // Errors: invalid options, and a room that cannot be modelled (no scene, empty room, no access
  // point). An access point without chain gains or with a single antenna is left out, with a
  // warning in every estimate.
  static Expected<Localizer> create(std::shared_ptr<const RoomModel> room,
                                    const LocalizerOptions& options);
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  // `frames`: one transmitter, any access points, in order of time. A fix lies within the room's
  // bounds, 1 cm inside. Without a fix, `reason` states the cause: no usable frames, or the descent
  // ended at a position without a path to any access point.
  LocationEstimate locate(std::span<const CsiFrame> frames) const;
  // With another seed than that of the options: for studies of many random starts.
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t seed) const;

  // The loss of these frames at a position: for tests and studies. Empty if no access point
  // received usable frames.
  std::optional<LossInPlan> loss(std::span<const CsiFrame> frames, const Vec3d& position) const;

  const RoomModel& room() const;

 private:
  class Impl;
  explicit Localizer(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc::paper
