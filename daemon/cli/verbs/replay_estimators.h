// The estimators of `rayloc replay` and their command-line options.
#pragma once

#include <memory>
#include <string>

#include "daemon/methods/method_registry.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/person_estimator.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct EstimatorArguments {
  std::string kind = "all";
  std::string target_key;  // file; empty: devices are named by their addresses
  double target_rotate_h = 24.0;
  ChainKeeper::Options chains;
  std::string snapshots = "always";
  bool no_cache = false;
  bool quiet = false;
};

// Estimators of the requested kinds of targets.
struct Estimators {
  std::unique_ptr<DeviceEstimator> devices;
  std::unique_ptr<PersonEstimator> people;
  EstimatorList all;
};

Expected<Estimators> make_estimators(const EstimatorArguments& options,
                                     const Site& site,
                                     const Method& method,
                                     const MethodOptions& settings,
                                     const std::shared_ptr<const Carried>& carried);

}  // namespace rayloc::cli
