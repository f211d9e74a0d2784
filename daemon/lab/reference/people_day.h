// Checks that people were recorded with the chain phases of the empty room to which they are
// compared. After a power cycle the phases differ, the echo of a person has no common factor any
// more, and its fit converges to a limit: the empty room of the day of the people is then required.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/person/calibrate/another_day.h"
#include "engine/person/calibrate/person_fit.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct RotatedChain {
  std::size_t row = 0;
  double angle = 0.0;  // [rad], relative to the first chain
};
// The chain with the largest rotation of those that exceed the limits: a noisy chain may have a
// larger angle.
std::optional<RotatedChain> find_rotated(const RotatedChains& chains);

// Before the fit, in milliseconds: compares the channel that is common to most of the `points`
// (frames of each) with the empty room of each link. An Error (kBadInput) names the access points
// whose chains are rotated in between, and --people-empty. An access point whose channel has too
// little in common with its empty room to measure a rotation, as in a small room with few places,
// is accepted. REQUIRES: the access points of the links are calibrated.
Expected<void> check_people_day(const RoomModel& room,
                                const PersonReference& reference,
                                const std::vector<std::vector<CsiFrame>>& points);

// After the fit to `points`: an Error (kBadInput) when the echo factor of every link that received
// people is at a limit of its search. REQUIRES: the points have an array, or an empty one, for each
// link of `fitted`.
Expected<void> check_echo_factors(const RoomModel& room,
                                  const PersonReference& fitted,
                                  const std::vector<PersonPoint>& points);

}  // namespace rayloc
