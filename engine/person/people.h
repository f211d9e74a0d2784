// People: several at once without devices, from one burst of a fixed transmitter (METHODS B5, B6).
//
// Two are found by turns: from the best places of one, where would another be beside that one
// (PersonContext), where then the first beside that other, and so on. They are believed when both
// explain the burst better than one does by more than what errors of the model of one are worth
// (PersonModel::second_person, learned from people at known places). Each is then stated with the
// other where it most probably is.
//
// A single link hears too little of two to say where they are (engine/studies/2026-11-people.md has
// the figures): it takes two access points. A third person is not looked for.
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

// The best two places of which one is near one of the best of `alone`. Nothing where one person
// explains the burst as well as the model expects to, or a single access point heard it.
// `alone`: what localizer.map() says of the observation. REQUIRES: observation.arrays is not empty.
std::optional<PersonPair> best_pair(const PersonLocalizer& localizer,
                                    const PersonObservation& observation,
                                    double likelihood_exponent,
                                    const PersonMap& alone);

// What a burst says of one person or of two: PersonLocalizer::map() where no second one is seen.
// REQUIRES: observation.arrays is not empty.
std::vector<PersonMap> map_people(const PersonLocalizer& localizer,
                                  const PersonObservation& observation);

// One estimate for each; as PersonLocalizer::locate() where no second one is seen. Of two, one may
// be no fix, for a reason of its own.
std::vector<LocationEstimate> locate_people(const PersonLocalizer& localizer,
                                            std::span<const CsiFrame> frames);

}  // namespace rayloc
