#include "engine/paper/evaluator.h"

#include <optional>
#include <utility>

#include "engine/base/constants.h"
#include "engine/base/parallel.h"

namespace rayloc::paper {
namespace {

std::vector<double> lines_of_sight(const AntennaArray& array, const Vec3d& device) {
  std::vector<double> delay;
  for (std::size_t i = 0; i < array.element_offset.size(); ++i) {
    delay.push_back(norm(element_position(array, i) - device) / kSpeedOfLight);
  }
  return delay;
}

}  // namespace

Evaluator::Evaluator(const RoomModel& room,
                     std::span<const Sample> samples,
                     const TraceOptions& tracing,
                     const Loss& loss)
    : room_(room), samples_(samples), tracing_(tracing), loss_(loss), measured_(samples.size()) {
  parallel_for(samples.size(), 4, [&](std::size_t i) {
    const AntennaArray& array = room.access_points[samples[i].access_point].array;
    measured_[i] = loss.measure(samples[i].h, lines_of_sight(array, samples[i].position));
  });
}

Expected<Evaluator::Evaluation> Evaluator::evaluate_sample(
    std::size_t sample,
    const ArrayTracer& tracer,
    LossKind differentiated,
    std::span<const Parameter> parameters) const {
  const Transmitter device = device_of(room_, samples_[sample].position);
  const Loss::Measured& measured = measured_[sample];
  const auto paths = tracer.trace(device);
  const auto expected = array_csi(paths, room_.grid);
  const auto derivatives = tracer.differentiate(device, paths, parameters);
  RAYLOC_TRY(derivatives);
  return Evaluation{
      loss_.value(LossKind::kDelay, measured, expected),
      loss_.value(LossKind::kRatioAmplitude, measured, expected),
      array_loss_gradient(
          *derivatives, paths, room_.grid, loss_.adjoint(differentiated, measured, expected))};
}

Expected<Evaluator::Evaluation> Evaluator::evaluate(const std::shared_ptr<const Scene>& scene,
                                                    LossKind differentiated,
                                                    std::span<const Parameter> parameters) const {
  const auto tracers = array_tracers(room_, PathTracer(scene, tracing_), samples_);
  std::vector<std::optional<Expected<Evaluation>>> each(samples_.size());
  parallel_for(samples_.size(), 2, [&](std::size_t i) {
    each[i] = evaluate_sample(i, *tracers[samples_[i].access_point], differentiated, parameters);
  });
  Evaluation mean;
  mean.gradient.resize(parameters.size());
  const double share = 1.0 / static_cast<double>(samples_.size());
  for (const auto& one : each) {
    if (!one->has_value()) {
      return tl::make_unexpected(one->error());
    }
    mean.delay += share * (*one)->delay;
    mean.ratio_amplitude += share * (*one)->ratio_amplitude;
    for (std::size_t i = 0; i < mean.gradient.size(); ++i) {
      mean.gradient[i] += share * (*one)->gradient[i];
    }
  }
  return mean;
}

}  // namespace rayloc::paper
