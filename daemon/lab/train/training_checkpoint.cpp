#include "daemon/lab/train/training_checkpoint.h"

#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/site/model/site_copy.h"
#include "daemon/site/model/weights_file.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCheckpointParts =
    3;  // parameters, means and squares of their gradients, equal counts

fs::path numbers_file(const fs::path& folder, const std::string& method) {
  return folder / (method + ".checkpoint.json");
}
fs::path weights_file(const fs::path& folder, const std::string& method) {
  return folder / (method + ".checkpoint.f32");
}

}  // namespace

Expected<void> write_checkpoint(const fs::path& folder,
                                const std::string& method,
                                const std::string& inputs,
                                const TrainingCheckpoint& checkpoint) {
  const TrainingState& state = checkpoint.network;
  std::vector<float> all = state.parameters;
  all.insert(all.end(), state.mean.begin(), state.mean.end());
  all.insert(all.end(), state.square.begin(), state.square.end());
  const std::string bytes = weights_bytes(all);
  const nlohmann::ordered_json numbers = {{"inputs", inputs},
                                          {"weights", weights_hash(bytes)},
                                          {"stage", checkpoint.stage},
                                          {"temperature", checkpoint.temperature},
                                          {"residual", checkpoint.residual},
                                          {"epoch", state.epoch},
                                          {"steps", state.steps},
                                          {"loss", state.loss}};
  // An interruption between the two writes leaves weights that the numbers do not match.
  RAYLOC_TRY(write_file(weights_file(folder, method), bytes));
  return write_file(numbers_file(folder, method), numbers.dump(1) + "\n");
}

Expected<TrainingCheckpoint> read_checkpoint(const fs::path& folder,
                                             const std::string& method,
                                             const std::string& inputs) {
  const fs::path file = numbers_file(folder, method);
  const auto refuse = [&](const std::string& why) {
    return bad_input(file.string() + ": " + why + "; train without --resume");
  };
  const auto text = read_file(file);
  if (!text) {
    return refuse("there is nothing to go on with");
  }
  const auto numbers = nlohmann::json::parse(*text, nullptr, false);
  TrainingCheckpoint checkpoint;
  std::string weights;
  try {
    if (numbers.at("inputs").get<std::string>() != inputs) {
      return refuse("was begun with another site, survey, seed or settings");
    }
    weights = numbers.at("weights").get<std::string>();
    checkpoint.stage = numbers.at("stage").get<std::size_t>();
    checkpoint.temperature = numbers.at("temperature").get<double>();
    checkpoint.residual = numbers.at("residual").get<double>();
    checkpoint.network.epoch = numbers.at("epoch").get<std::size_t>();
    checkpoint.network.steps = numbers.at("steps").get<std::size_t>();
    checkpoint.network.loss = numbers.at("loss").get<std::vector<double>>();
  } catch (const nlohmann::json::exception&) {
    return refuse("is broken");
  }
  const fs::path floats = weights_file(folder, method);
  const auto bytes = read_file(floats);
  const auto all = bytes ? parse_weights(*bytes, floats)
                         : Expected<std::vector<float>>(tl::make_unexpected(bytes.error()));
  if (!all || weights_hash(*bytes) != weights || all->size() % kCheckpointParts != 0) {
    return refuse("its weights are not those of " + floats.string());
  }
  const auto count = static_cast<std::ptrdiff_t>(all->size() / kCheckpointParts);
  TrainingState& state = checkpoint.network;
  state.parameters.assign(all->begin(), all->begin() + count);
  state.mean.assign(all->begin() + count, all->begin() + 2 * count);
  state.square.assign(all->begin() + 2 * count, all->end());
  return checkpoint;
}

void remove_checkpoint(const fs::path& folder, const std::string& method) {
  std::error_code ignored;
  fs::remove(numbers_file(folder, method), ignored);
  fs::remove(weights_file(folder, method), ignored);
}

}  // namespace rayloc
