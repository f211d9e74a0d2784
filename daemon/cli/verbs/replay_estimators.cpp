#include "daemon/cli/verbs/replay_estimators.h"

#include <cstdio>
#include <utility>

#include "daemon/messages/target_names.h"
#include "daemon/site/model/path_grid_files.h"
#include "daemon/site/scene/scene_notes.h"

namespace rayloc::cli {
namespace {

// Returns nullptr if grids are not to be kept, or if there is no folder for them.
std::shared_ptr<PathGridStore> path_grids(const EstimatorArguments& options) {
  const auto directory = options.no_cache ? std::nullopt : cache_directory();
  if (!directory) {
    return nullptr;
  }
  PathGridFiles::Options files;
  files.directory = *directory;
  if (!options.quiet) {
    files.log = [](const std::string& line) {
      std::fprintf(stderr, "rayloc replay: cache: %s\n", line.c_str());
    };
  }
  return std::make_shared<PathGridFiles>(std::move(files));
}

Expected<std::shared_ptr<TargetNames>> target_names(const EstimatorArguments& options) {
  TargetNames::Options names;
  if (!options.target_key.empty()) {
    Expected<std::string> key = TargetNames::read_key(options.target_key);
    if (!key) {
      return tl::make_unexpected(key.error());
    }
    names.hashed = true;
    names.key = *std::move(key);
    names.period = from_seconds(3600.0 * options.target_rotate_h);
  }
  return std::make_shared<TargetNames>(std::move(names));
}

}  // namespace

Expected<Estimators> make_estimators(const EstimatorArguments& options,
                                     const Site& site,
                                     const Method& method,
                                     const MethodOptions& settings,
                                     const std::shared_ptr<const Carried>& carried) {
  Estimators estimators;
  if (options.kind != "person" && method.create_device != nullptr) {
    DeviceEstimator::Options estimation;
    auto names = target_names(options);
    if (!names) {
      return tl::make_unexpected(names.error());
    }
    estimation.names = *std::move(names);
    estimation.method = &method;
    estimation.settings = settings;
    estimation.settings.path_grids = path_grids(options);
    estimation.chains = options.chains;
    estimation.snapshots =
        options.snapshots == "acquire" ? Snapshots::kAcquire : Snapshots::kAlways;
    estimation.before = carried;
    auto devices = DeviceEstimator::create(site, estimation);
    if (!devices) {
      return tl::make_unexpected(devices.error());
    }
    estimators.devices = *std::move(devices);
    estimators.all.add(*estimators.devices);
  }
  // Without a reference no person can be located; a request for people alone gets that error.
  if (options.kind == "person" || estimators.devices == nullptr ||
      (options.kind == "all" && method.create_person != nullptr && site.reference_file)) {
    PersonEstimator::Options estimation;
    estimation.method = &method;
    estimation.settings = settings;
    estimation.before = carried;
    auto people = PersonEstimator::create(site, estimation);
    if (!people) {
      return tl::make_unexpected(people.error());
    }
    estimators.people = *std::move(people);
    estimators.all.add(*estimators.people);
  }
  if (!options.quiet) {
    print_scene_notes(
        *(estimators.devices ? estimators.devices->room() : estimators.people->room()).scene);
  }
  return estimators;
}

}  // namespace rayloc::cli
