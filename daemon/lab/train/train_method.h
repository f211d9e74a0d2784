// train_method: trains a method on a survey, and checks it with the points that were held out.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>

#include "daemon/base/observer.h"
#include "daemon/lab/evaluate/error_statistics.h"
#include "daemon/lab/train/train_inputs.h"
#include "engine/base/expected.h"
#include "engine/baselines/training.h"

namespace rayloc {

// Checkpoints of a training that can be interrupted (training_checkpoint.h).
struct TrainCheckpoints {
  std::filesystem::path folder;  // empty: none are written
  bool resume = false;           // continues from the checkpoint in the folder
};

struct TrainedMethod {
  std::shared_ptr<const Training> training;
  std::optional<ErrorStatistics> held_out;  // errors of the points excluded from training
  double seconds = 0.0;                     // duration of the training
};

// A checkpoint that cannot be written is a note. A network stops after the epoch in which a stop is
// requested: an Error (kUnavailable), and a checkpoint of that epoch. Other Errors: there is no
// checkpoint of the same inputs to resume from, the survey does not suffice for the method.
Expected<TrainedMethod> train_method(const TrainInputs& inputs,
                                     const TrainCheckpoints& checkpoints,
                                     const Observer& observer,
                                     const std::stop_token& stop);

}  // namespace rayloc
