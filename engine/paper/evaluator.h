// Evaluator: both losses of the paper's calibration over all points, in any scene, with the
// gradient of one of them from the tracer's derivatives.
//
// Thread safety: const members may be used from many threads. Results do not depend on the number
// of threads.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/paper/loss.h"
#include "engine/paper/samples.h"
#include "engine/trace/parameter.h"

namespace rayloc::paper {

class Evaluator {
 public:
  // The arguments must outlive the evaluator.
  Evaluator(const RoomModel& room,
            std::span<const Sample> samples,
            const TraceOptions& tracing,
            const Loss& loss);

  struct Evaluation {
    double delay = 0.0;            // L_p, mean over the samples
    double ratio_amplitude = 0.0;  // L_m
    std::vector<double> gradient;  // of the requested loss, by each parameter
    double sum() const { return delay + ratio_amplitude; }
  };

  // Errors: as of ArrayTracer::differentiate().
  Expected<Evaluation> evaluate(const std::shared_ptr<const Scene>& scene,
                                LossKind differentiated,
                                std::span<const Parameter> parameters) const;

 private:
  Expected<Evaluation> evaluate_sample(std::size_t sample,
                                       const ArrayTracer& tracer,
                                       LossKind differentiated,
                                       std::span<const Parameter> parameters) const;

  const RoomModel& room_;
  std::span<const Sample> samples_;
  TraceOptions tracing_;
  const Loss& loss_;
  std::vector<Loss::Measured> measured_;  // of each sample
};

}  // namespace rayloc::paper
