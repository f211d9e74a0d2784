// A burst has noise of its own beside that of the model, n' beside n, which the W of a map lacks
// (PlaceModel). Where it counts the map is asked in another way, at the cost of two products with W
// more. With e what the mean leaves of the burst, a = e^H Sigma^-1 e and b = e^H Sigma^-2 e,
//
//   e^H (Sigma + n' I / D)^-1 e  ~  a / (1 + n' / D (b / a)),
//   ln |Sigma + n' I / D|        ~  ln |Sigma| + D ln (1 + n' / D (tr Sigma^-1 / D)).
//
// Both take the mean of the inverse eigenvalues for all of them: by Jensen's inequality the first
// is too small and the second too large, so that little of it is left in their sum.
#pragma once

#include <cstddef>

#include "engine/likelihood/observed_array.h"
#include "engine/likelihood/place_model.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Whether a burst is so weak that a place's model, which lacks its noise, is not enough.
bool lacks_noise(const PlaceModel& place, const ObservedArray& observed);

// ObservationModel::log_likelihood() at one delay of a block of the burst, with the burst's noise.
// REQUIRES: lacks_noise(place, observed).
double log_likelihood_with_noise(const PlaceModel& place,
                                 const ObservedArray& observed,
                                 const ObservedArray::Block& block,
                                 std::size_t lane);

// What a model must be made with to have the burst's noise.
ModelError with_noise(ModelError error, const ObservedArray& observed);

}  // namespace rayloc
