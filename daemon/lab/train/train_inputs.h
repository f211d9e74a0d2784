// TrainInputs: the method that is trained, its site and the survey it learns from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "daemon/lab/train/train_survey.h"
#include "daemon/methods/method.h"
#include "daemon/methods/method_options.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct TrainOptions {
  std::string site;    // directory of a calibrated site
  std::string method;  // one of trained_methods()
  SurveyArguments survey;
  std::string time_offset;            // [s], added to the times of the points; empty: none
  std::vector<std::string> baseline;  // KEY=VALUE, settings of the method
  double holdout = 0.2;               // share of the points, 0 to 0.8
  std::uint64_t seed = 1;             // of the draw of these points, and of the method
  std::filesystem::path out;          // folder for the new site, checked before any work
  bool force = false;                 // `out` may hold files
};

struct TrainInputs {
  const Method* method = nullptr;  // has `train`
  MethodOptions settings;          // with the seed
  Site site;
  std::shared_ptr<const RoomModel> room;
  TrainSurvey survey;
  std::vector<bool> held;  // by point of the survey: held out from the training
  std::string hash;        // of everything that the result depends on
};

// Names of the methods that are trained on a survey, in the order of the registry.
std::vector<std::string> trained_methods();

// Errors: invalid options (kUsage), a site without a calibration (kConfiguration), a survey that
// does not fit the site (as of read_device_survey(), read_people_survey()).
Expected<TrainInputs> read_train_inputs(const TrainOptions& options);

}  // namespace rayloc
