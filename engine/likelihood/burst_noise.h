// A burst has noise n' of its own in addition to the noise n of the model; the W of a map does not
// include n' (PlaceModel). Where n' matters, the likelihood is corrected at the cost of two more
// products with W. With e the residual of the burst, a = e^H Sigma^-1 e and b = e^H Sigma^-2 e,
//
//   e^H (Sigma + n' I / D)^-1 e  ~  a / (1 + n' / D (b / a)),
//   ln |Sigma + n' I / D|        ~  ln |Sigma| + D ln (1 + n' / D (tr Sigma^-1 / D)).
//
// Both replace the inverse eigenvalues by their mean: by Jensen's inequality the first term is too
// small and the second too large, so that little error is left in their sum.
#pragma once

#include <cstddef>

#include "engine/likelihood/observed_array.h"
#include "engine/likelihood/place_model.h"
#include "engine/room/room_model.h"

namespace rayloc {

// True if a burst is so weak that a place's model, which lacks its noise, is not accurate enough.
bool lacks_noise(const PlaceModel& place, const ObservedArray& observed);

// ObservationModel::log_likelihood() at one delay of a block of the burst, with the burst's noise.
// REQUIRES: lacks_noise(place, observed).
double log_likelihood_with_noise(const PlaceModel& place,
                                 const ObservedArray& observed,
                                 const ObservedArray::Block& block,
                                 std::size_t lane);

// Model error that includes the burst's noise.
ModelError with_noise(ModelError error, const ObservedArray& observed);

}  // namespace rayloc
