#include "daemon/lab/train/trained_site.h"

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/lab/train/training_checkpoint.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/model/training_file.h"
#include "daemon/site/model/weights_file.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

std::string report_text(const std::string& method, const TrainedMethod& trained) {
  nlohmann::ordered_json report = {{"method", method}, {"seconds", trained.seconds}};
  if (trained.held_out) {
    report["held_out"] = {{"n", trained.held_out->n}, {"missed", trained.held_out->missed}};
    if (trained.held_out->missed < trained.held_out->n) {
      report["held_out"]["median_m"] = trained.held_out->median_m;
      report["held_out"]["in_95"] = trained.held_out->coverage_95.value_or(0.0);
    }
  }
  if (trained.training->network) {
    report["epochs"] = trained.training->network->loss;
  }
  return report.dump(1) + "\n";
}

Expected<void> write_training(const TrainInputs& inputs,
                              const Training& training,
                              const fs::path& file) {
  const std::string text = training_toml(training, inputs.site, inputs.survey.content);
  RAYLOC_TRY(write_file(file, text));
  if (!training.network) {
    return {};
  }
  return write_file(fs::path(file).replace_extension(".f32"),
                    weights_bytes(training.network->parameters));
}

}  // namespace

Expected<void> write_trained_site(const TrainInputs& inputs,
                                  const TrainedMethod& trained,
                                  const fs::path& out) {
  const auto calibration = read_file(*inputs.site.calibration_file);
  RAYLOC_TRY(calibration);
  const std::string method(inputs.method->name);
  const fs::path folder = out / "training";
  const fs::path file = folder / (method + ".toml");
  RAYLOC_TRY(write_training(inputs, *trained.training, file));
  Site site = inputs.site;
  site.training_files.insert_or_assign(method, file);
  RAYLOC_TRY(write_site(site, *calibration, out));
  const std::string report = report_text(method, trained);
  remove_checkpoint(folder, method);
  return write_file(folder / (method + "-report.json"), report);
}

}  // namespace rayloc
