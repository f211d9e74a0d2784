// The ports of `rayloc survey`: from --listen, or from the live sources of a raylocd.
#pragma once

#include <string>
#include <vector>

#include "daemon/site/model/site.h"
#include "daemon/site/survey/survey_listener.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Values as written on the command line.
struct SurveyPortArguments {
  std::string site;    // directory
  std::string config;  // of a raylocd
  std::string name;    // one of several sites in `config`
  std::vector<std::string> listen;
  std::vector<std::string> record;
};

// An Error (kUsage) unless exactly one of `listen` and `config` is stated, and they and `record`
// name access points of the site.
Expected<std::vector<SurveyPort>> survey_ports(const SurveyPortArguments& arguments,
                                               const Site& site);

}  // namespace rayloc::cli
