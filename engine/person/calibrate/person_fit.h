// fit_person: from people at known places, the effect of a person on the fixed links of this site:
// the complex factor of each access point, the body's radius, the errors of the model and the
// exponent of the likelihood with which reported probabilities are valid (METHODS B5).
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/person/person_localizer.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A person at a known place, as received by the links of a reference.
struct PersonPoint {
  TargetPosition place;
  // For each link, [rx_chain][tone] with chain gains removed; empty where the link received
  // nothing.
  std::vector<std::vector<std::complex<double>>> h;
};

struct PersonFitOptions {
  double place_sigma = 0.01;        // [m], along each axis of the known places
  double transmitter_sigma = 0.01;  // [m], along each axis of the transmitter's place
  double radius_sigma = 0.02;       // [m], of people about the stated one
  double least_radius = 0.05;       // [m]
  int depth = PersonLocalizerOptions{}.depth;
  // [m], offsets from the stated radius to try. Empty: the geometry is not fitted.
  std::vector<double> radius_steps{0.0, -0.03, -0.02, -0.01, 0.01, 0.02, 0.03};
};

struct PersonFit {
  PersonReference reference;    // with `scale` of every link and `person` as fitted
  double log_likelihood = 0.0;  // of the points, over that of the empty room
  std::size_t points = 0;       // number of points used
};

// An Error when fewer than kMinPersonPoints points can be used. `likelihood_exponent` is not fitted
// here.
inline constexpr std::size_t kMinPersonPoints = 8;
Expected<PersonFit> fit_person(const RoomModel& room,
                               const PersonReference& reference,
                               std::span<const PersonPoint> points,
                               const PersonFitOptions& options = {});

// True if the absolute value of `scale` of a fitted link is at an end of the range that is searched
// (0.35 to 1.80): the body does not explain what the link received.
bool is_scale_at_limit(std::complex<double> scale);

}  // namespace rayloc
