// fit_model_error: how far a room differs from its model (ModelError), by what it says of bursts
// from surveyed points.
//
// All of it at once: what surfaces, diffuse power and the rest explain is exchanged between them,
// and one after the other ends far from the best (engine/calibrate/README.md, *Considered and
// rejected*).
#pragma once

#include <functional>

#include "engine/room/fitted.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct FittedModelError {
  Fitted<double> plan_tolerance;  // [m]
  Fitted<double> diffuse;
  Fitted<double> diffuse_exponent;
  Fitted<double> diffuse_decay;  // [s]
  Fitted<double> noise;

  ModelError value() const {
    return {plan_tolerance.value,
            diffuse.value,
            diffuse_exponent.value,
            diffuse_decay.value,
            noise.value};
  }
};

// What a floor plan is worth: nothing was fitted.
FittedModelError assumed_model_error();

// The maximum of `log_evidence` and of a wide prior about assumed_model_error(); begun at `start`.
// log_evidence: a log-likelihood of which one unit is one unit of evidence; called some 200 times,
// from one thread. The sigmas are those of the Gaussian about the maximum, whatever the others are.
FittedModelError fit_model_error(const std::function<double(const ModelError&)>& log_evidence,
                                 const FittedModelError& start);

}  // namespace rayloc
