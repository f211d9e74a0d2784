#include "daemon/lab/train/train_method.h"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "daemon/lab/train/training_checkpoint.h"
#include "daemon/methods/device_method.h"
#include "daemon/methods/person_method.h"

namespace rayloc {
namespace {

TrainingInput training_input(const TrainInputs& inputs,
                             const Observer& observer,
                             const std::stop_token& stop) {
  TrainingInput input;
  input.room = inputs.room;
  input.values = inputs.settings.values;
  input.seed = inputs.settings.seed;
  input.empty = inputs.survey.empty;
  input.transmitter = inputs.survey.transmitter;
  for (const SiteTransmitter& transmitter : inputs.site.transmitters) {
    if (transmitter.constant_power) {
      input.constant_power.push_back(transmitter.mac);
    }
  }
  for (std::size_t i = 0; i < inputs.survey.points.size(); ++i) {
    if (!inputs.held[i]) {
      input.points.push_back(inputs.survey.points[i]);
    }
  }
  input.progress = [&observer](const TrainingProgress& progress) {
    observer.progress(progress.share, progress.what);
  };
  input.stop_requested = [&stop] { return stop.stop_requested(); };
  return input;
}

// Trains with checkpoints; one that cannot be written is a note.
Expected<std::shared_ptr<const Training>> train_with_checkpoints(
    const TrainInputs& inputs,
    TrainingInput input,
    const TrainCheckpoints& checkpoints,
    const Observer& observer) {
  const std::string method(inputs.method->name);
  if (checkpoints.resume) {
    auto reached = read_checkpoint(checkpoints.folder, method, inputs.hash);
    RAYLOC_TRY(reached);
    input.resume = *std::move(reached);
  }
  Expected<void> kept;
  if (!checkpoints.folder.empty()) {
    input.keep = [&](const TrainingCheckpoint& checkpoint) {
      if (kept) {
        kept = write_checkpoint(checkpoints.folder, method, inputs.hash, checkpoint);
      }
    };
  }
  auto training = inputs.method->train(input);
  if (training && !kept) {
    observer.note("warning: " + kept.error().message +
                  "; after an interruption --resume could not have gone on");
  }
  return training;
}

// Locates with the method and the trained values.
Expected<LocationEstimate> locate_trained(const TrainInputs& inputs,
                                          const std::shared_ptr<const Training>& training,
                                          const std::vector<CsiFrame>& frames) {
  if (inputs.method->create_device != nullptr) {
    DeviceMethodInput input{inputs.room, inputs.settings};
    input.training = training;
    auto made = inputs.method->create_device(std::move(input));
    return made ? Expected<LocationEstimate>((*made)->locate(frames, 0))
                : tl::make_unexpected(std::move(made.error()));
  }
  PersonReference reference{};
  reference.mac = inputs.survey.transmitter.value_or(MacAddress{});
  PersonMethodInput input{inputs.room, std::move(reference), inputs.settings};
  input.training = training;
  auto made = inputs.method->create_person(std::move(input));
  return made ? Expected<LocationEstimate>((*made)->locate(frames, 0).front())
              : tl::make_unexpected(std::move(made.error()));
}

// Empty if no point is held out.
Expected<std::optional<ErrorStatistics>> check_held_out(
    const TrainInputs& inputs, const std::shared_ptr<const Training>& training) {
  std::vector<PointResult> results;
  for (std::size_t i = 0; i < inputs.survey.points.size(); ++i) {
    if (!inputs.held[i]) {
      continue;
    }
    TruthPoint truth;
    truth.position = inputs.survey.points[i].position;
    const auto estimate = locate_trained(inputs, training, inputs.survey.points[i].frames);
    RAYLOC_TRY(estimate);
    results.push_back(evaluate_point(truth, &*estimate));
  }
  std::optional<ErrorStatistics> statistics;
  if (!results.empty()) {
    statistics = compute_statistics(results, {}, {});
  }
  return statistics;
}

}  // namespace

Expected<TrainedMethod> train_method(const TrainInputs& inputs,
                                     const TrainCheckpoints& checkpoints,
                                     const Observer& observer,
                                     const std::stop_token& stop) {
  TrainedMethod trained;
  const auto begin = std::chrono::steady_clock::now();
  auto training =
      train_with_checkpoints(inputs, training_input(inputs, observer, stop), checkpoints, observer);
  RAYLOC_TRY(training);
  trained.training = *std::move(training);
  trained.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  auto held_out = check_held_out(inputs, trained.training);
  RAYLOC_TRY(held_out);
  trained.held_out = *std::move(held_out);
  return trained;
}

}  // namespace rayloc
