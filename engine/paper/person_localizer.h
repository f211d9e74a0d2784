// PersonLocalizer: the published method of device-free localization (METHODS A4): moves the
// target in the scene, with transmitter and access points fixed.
//
//   L(P) = mean over links of (MSE(a) + gamma_1 MSE(tau)) + gamma_2 |xy - c|^2
//
// as in Localizer for a device, except for the expected channel: that of the measured empty
// room plus the contribution of a body at P (PersonReference). It starts at a random place and
// stays in the room, the body clear of the bounds; it uses no furniture and no area.
//
// The result is one position, on the floor, without covariance, accuracy or hypotheses
// (LocationEstimate::is_uncertainty_stated is false). The published method assumes that a person is
// present: it also returns a position for an empty room.
//
// Starts and random numbers: see Search.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/paper/options.h"
#include "engine/person/person_reference.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc::paper {

class PersonLocalizer {
 public:
  // Errors: invalid options, and an unusable room, reference or body. A link whose access point has
  // a single antenna is left out, with a warning in every estimate.
  static Expected<PersonLocalizer> create(std::shared_ptr<const RoomModel> room,
                                          const PersonReference& reference,
                                          const LocalizerOptions& options);
  ~PersonLocalizer();
  PersonLocalizer(PersonLocalizer&&) noexcept;
  PersonLocalizer& operator=(PersonLocalizer&&) noexcept;

  // `frames`: of the reference's transmitter, any access points, in order of time. Without a fix,
  // `reason` states the cause: no usable frames.
  LocationEstimate locate(std::span<const CsiFrame> frames) const;
  // With another seed than that of the options: for studies of many random starts.
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t seed) const;

  // The loss of these frames at a place: for tests and studies. Empty if no access point received
  // usable frames.
  std::optional<LossInPlan> loss(std::span<const CsiFrame> frames, const Vec3d& position) const;

 private:
  class Impl;
  explicit PersonLocalizer(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc::paper
