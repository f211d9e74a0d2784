// PaperPersonLocalizer: the published method of device-free localization (METHODS A4): the target
// in the scene is moved, transmitter and access points stay.
//
//   L(P) = mean over links of (MSE(a) + gamma_1 MSE(tau)) + gamma_2 |xy - c|^2
//
// as PaperLocalizer has it for a device, but for the channel that is expected: the empty room as
// measured and what a body at P adds (PersonReference). It starts at a random place and stays in
// the room, the body clear of the bounds; it knows of no furniture and of no area.
//
// It gives one position, on the floor, without covariance, accuracy or hypotheses
// (LocationEstimate::is_uncertainty_stated is false). The published method supposes that somebody
// is there: in an empty room it answers as well.
//
// Where it starts and what it draws: PaperSearch.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/paper/paper_options.h"
#include "engine/person/person_reference.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

class PaperPersonLocalizer {
 public:
  // An Error for options that make no sense, and when room, reference or body cannot be used. A
  // link whose access point has a single antenna is left out, with a warning in every estimate.
  static Expected<PaperPersonLocalizer> create(std::shared_ptr<const RoomModel> room,
                                               const PersonReference& reference,
                                               const PaperLocalizerOptions& options);
  ~PaperPersonLocalizer();
  PaperPersonLocalizer(PaperPersonLocalizer&&) noexcept;
  PaperPersonLocalizer& operator=(PaperPersonLocalizer&&) noexcept;

  // `frames`: of the reference's transmitter, any access points, in order of time. Without a fix,
  // `reason` says why: nothing usable was heard.
  LocationEstimate locate(std::span<const CsiFrame> frames) const;
  // With another seed than that of the options: for studies of many random starts.
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t seed) const;

  // The loss of these frames at a place: for tests and studies. Nothing when no access point heard
  // them.
  std::optional<LossInPlan> loss(std::span<const CsiFrame> frames, const Vec3d& position) const;

 private:
  class Impl;
  explicit PaperPersonLocalizer(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc
