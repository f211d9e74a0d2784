// Checks that people were recorded with the chain phases of the empty room to which they are
// compared. After a power cycle the phases differ, the echo of a person has no common factor any
// more, and its fit converges to a limit: the empty room of the day of the people is then required.
#pragma once

#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Before the fit, in milliseconds: compares the channel that is common to most of the `points`
// (frames of each) with the empty room of each link. An Error (kBadInput) names the access points
// whose chains are rotated in between, and --people-empty. An access point whose channel has too
// little in common with its empty room to measure a rotation, as in a small room with few places,
// is accepted. REQUIRES: the access points of the links are calibrated.
Expected<void> check_people_day(const RoomModel& room,
                                const PersonReference& reference,
                                const std::vector<std::vector<CsiFrame>>& points);

// After the fit: an Error (kBadInput) when the echo factor of every link is at a limit of its
// search. REQUIRES: `fitted` has a link.
Expected<void> check_echo_factors(const RoomModel& room, const PersonReference& fitted);

}  // namespace rayloc
