// The estimators of a replay: of devices, of people, or of all that the site can locate.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "daemon/base/observer.h"
#include "daemon/methods/method_registry.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/person_estimator.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/localize/path_grid.h"

namespace rayloc::replay {

enum class Kind : std::uint8_t {
  kDevice,
  kPerson,  // needs a reference of the empty room
  kAll,     // that the site and the method can locate
};

struct EstimatorOptions {
  Kind kind = Kind::kAll;
  const Method* method = &default_method();
  MethodOptions settings;
  std::shared_ptr<PathGridStore> path_grids;  // for devices; null: no grid is kept
  std::string target_key;  // file with the key of hashed names; empty: devices have their addresses
  Duration target_period = std::chrono::hours(24);  // from one hashed name to the next
  ChainKeeper::Options chains;
  Snapshots snapshots = Snapshots::kAlways;
};

// Refers to itself by heap addresses only: it can be moved.
struct Estimators {
  std::unique_ptr<DeviceEstimator> devices;  // null: only people are located
  std::unique_ptr<PersonEstimator> people;   // null: only devices are located
  EstimatorList all;
};

// An Error (kUsage) where the method does not locate the requested kind.
Expected<void> check_kind(const Method& method, Kind kind);

// Reads the scene and prepares the room: up to a minute. `carried`: state of a predecessor; null:
// none. Reports the notes on the scene to `observer`. Errors: see check_kind(); a key file
// or a room that cannot be read; people alone in a site without a reference.
Expected<Estimators> make_estimators(const EstimatorOptions& options,
                                     const Site& site,
                                     const std::shared_ptr<const Carried>& carried,
                                     const Observer& observer);

}  // namespace rayloc::replay
