// fit_model_error: errors of a room's model (ModelError), from its likelihood of bursts from
// surveyed points.
//
// All parameters are fitted at once: surfaces, diffuse power and the rest can explain the same
// power, and fitting one after the other ends far from the optimum (engine/calibrate/README.md,
// *Considered and rejected*).
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

// Errors of an unfitted floor plan.
FittedModelError assumed_model_error();

// The maximum of `log_evidence` and a wide prior about assumed_model_error(), from `start` on.
// log_evidence: a log-likelihood of which one unit is one unit of evidence; called some 200 times,
// from one thread. The sigmas are those of the Gaussian about the maximum, others marginalised.
FittedModelError fit_model_error(const std::function<double(const ModelError&)>& log_evidence,
                                 const FittedModelError& start);

}  // namespace rayloc
