#include "daemon/lab/train/train_inputs.h"

#include <utility>

#include "daemon/lab/calibrate/holdout.h"
#include "daemon/methods/method_registry.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/survey/time_offset.h"
#include "engine/base/content_hash.h"
#include "engine/baselines/settings.h"

namespace rayloc {
namespace {

constexpr double kMaxHeldOut = 0.8;  // share of the points, as in `rayloc calibrate`

Expected<void> read_settings(const TrainOptions& options, TrainInputs& inputs) {
  inputs.method = find_method(options.method);
  if (inputs.method == nullptr || inputs.method->train == nullptr) {
    return make_error(ErrorKind::kUsage, "--method " + options.method + ": is not trained");
  }
  if (!(options.holdout >= 0.0 && options.holdout <= kMaxHeldOut)) {
    return make_error(ErrorKind::kUsage, "--holdout is a share of the points from 0 to 0.8");
  }
  const Method& method = *inputs.method;
  for (const std::string& text : options.baseline) {
    if (auto read = read_baseline_value(
            text, method.name, method.baseline_settings, inputs.settings.values);
        !read) {
      return make_error(ErrorKind::kUsage, "--baseline " + read.error().message);
    }
  }
  inputs.settings.seed = options.seed;
  return {};
}

Expected<void> load_place(const TrainOptions& options, TrainInputs& inputs) {
  auto site = load_calibrated_site(options.site,
                                   ", and methods learn in a calibrated room: run "
                                   "`rayloc calibrate` first",
                                   options.out,
                                   options.force);
  RAYLOC_TRY(site);
  inputs.site = *std::move(site);
  auto room = load_room_model(inputs.site);
  RAYLOC_TRY(room);
  inputs.room = std::make_shared<const RoomModel>(*std::move(room));
  return {};
}

Expected<void> read_survey(const TrainOptions& options, TrainInputs& inputs) {
  const Method& method = *inputs.method;
  if (!options.survey.empty.empty() && method.create_person == nullptr) {
    return make_error(ErrorKind::kUsage, "--empty is of methods that locate people; leave it out");
  }
  SurveyArguments arguments = options.survey;
  if (!options.time_offset.empty()) {
    const auto offset = parse_time_offset(options.time_offset);
    RAYLOC_TRY(offset);
    arguments.time_offset = *offset;
  }
  auto survey = method.create_device != nullptr
                    ? read_device_survey(inputs.site, *inputs.room, arguments)
                    : read_people_survey(inputs.site, arguments);
  RAYLOC_TRY(survey);
  inputs.survey = *std::move(survey);
  inputs.held = draw_holdout(inputs.survey.points.size(), options.holdout, options.seed);
  return {};
}

std::string hash_of_inputs(const TrainOptions& options, const TrainInputs& inputs) {
  ContentHash hash;
  hash.add(inputs.survey.content);
  hash.add(inputs.room->calibration_id);
  hash.add(options.method);
  hash.add(options.holdout);
  hash.add(options.seed);
  for (const std::string& text : options.baseline) {
    hash.add(text);
  }
  return hash.text();
}

}  // namespace

std::vector<std::string> trained_methods() {
  std::vector<std::string> names;
  for (const Method* method : methods()) {
    if (method->train != nullptr) {
      names.emplace_back(method->name);
    }
  }
  return names;
}

Expected<TrainInputs> read_train_inputs(const TrainOptions& options) {
  TrainInputs inputs;
  for (const auto step : {read_settings, load_place, read_survey}) {
    RAYLOC_TRY(step(options, inputs));
  }
  inputs.hash = hash_of_inputs(options, inputs);
  return inputs;
}

}  // namespace rayloc
