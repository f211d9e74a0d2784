// learn_reference: learns the empty room on the links of a site's fixed transmitters, and the
// effect of a person on these links.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/calibrate/report/refused_input.h"
#include "daemon/lab/reference/reference_inputs.h"
#include "engine/base/expected.h"
#include "engine/person/calibrate/two_days.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct LearnedReference {
  // Today's room. If today's chains are rotated it has their gains, and the id of a new
  // calibration.
  RoomModel room;
  std::vector<PersonReference> references;  // one per fixed transmitter
  std::vector<DayChange> changes;           // since the other day on which people were recorded
  std::size_t points = 0;                   // points of the person fit; 0: the person is as stated
  std::vector<RefusedInput> refused;        // inputs that were not used
};

// True if the phase of a chain has changed since the calibration, which then needs new gains.
bool has_rotated_chains(const std::vector<DayChange>& changes);

// Without people the person is the one that the site states. With people of another day
// (`people_empty`) the chain gains of that day are separated from today's first. Errors: an access
// point that is not calibrated (kConfiguration), a room that is not empty, points that share no
// time with the recordings, people of another day without `people_empty`, data that no person or
// room explains (kBadInput). The function has no state: threads may call it at the same time.
Expected<LearnedReference> learn_reference(const ReferenceInputs& inputs, const Observer& observer);

}  // namespace rayloc
