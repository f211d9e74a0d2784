// People: several people without devices, from one burst of a fixed transmitter (METHODS B5, B6).
//
// Two are found by alternation: given the best places of one, the best place of another
// (PersonContext), then that of the first given the other, and so on. They are accepted when both
// explain the burst better than one does, by more than errors of the model of one account for
// (PersonModel::second_person, learned from people at known places). Each is then reported with the
// other at its most probable place.
//
// A single link receives too little of two people to locate them (engine/studies/2026-11-people.md
// has the figures): two access points are needed. A third person is not searched for.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/person/person_localizer.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

struct PersonPair {
  std::array<PersonSample, 2> places;
  double gain = 0.0;  // of log-likelihood over one person alone
};

// The best two places of which one is near one of the best of `alone`. nullopt where one person
// explains the burst as well as the model expects, or a single access point received it. `alone`:
// localizer.map() of the observation. REQUIRES: observation.arrays is not empty.
std::optional<PersonPair> best_pair(const PersonLocalizer& localizer,
                                    const PersonObservation& observation,
                                    double likelihood_exponent,
                                    const PersonMap& alone);

// Maps of one person or of two: PersonLocalizer::map() where no second one is detected.
// REQUIRES: observation.arrays is not empty.
std::vector<PersonMap> map_people(const PersonLocalizer& localizer,
                                  const PersonObservation& observation);

// One estimate per person; as PersonLocalizer::locate() where no second one is detected. With two,
// one may be no fix, for a reason of its own.
std::vector<LocationEstimate> locate_people(const PersonLocalizer& localizer,
                                            std::span<const CsiFrame> frames);

}  // namespace rayloc
