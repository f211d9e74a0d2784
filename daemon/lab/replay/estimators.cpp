#include "daemon/lab/replay/estimators.h"

#include <utility>

#include "daemon/messages/target_names.h"
#include "daemon/site/scene/scene_notes.h"
#include "engine/scene/scene.h"

namespace rayloc::replay {
namespace {

Expected<std::shared_ptr<TargetNames>> target_names(const EstimatorOptions& options) {
  TargetNames::Options names;
  if (!options.target_key.empty()) {
    Expected<std::string> key = TargetNames::read_key(options.target_key);
    RAYLOC_TRY(key);
    names.hashed = true;
    names.key = *std::move(key);
    names.period = options.target_period;
  }
  return std::make_shared<TargetNames>(std::move(names));
}

Expected<std::unique_ptr<DeviceEstimator>> make_device_estimator(
    const EstimatorOptions& options,
    const Site& site,
    const std::shared_ptr<const Carried>& carried) {
  DeviceEstimator::Options estimation;
  auto names = target_names(options);
  RAYLOC_TRY(names);
  estimation.names = *std::move(names);
  estimation.method = options.method;
  estimation.settings = options.settings;
  estimation.settings.path_grids = options.path_grids;
  estimation.chains = options.chains;
  estimation.snapshots = options.snapshots;
  estimation.before = carried;
  return DeviceEstimator::create(site, estimation);
}

Expected<std::unique_ptr<PersonEstimator>> make_person_estimator(
    const EstimatorOptions& options,
    const Site& site,
    const std::shared_ptr<const Carried>& carried) {
  PersonEstimator::Options estimation;
  estimation.method = options.method;
  estimation.settings = options.settings;
  estimation.before = carried;
  // With an estimator of devices, its bursts provide the chains.
  if (options.kind == Kind::kPerson || options.method->create_device == nullptr) {
    estimation.chain_file = options.chains.read;
  }
  return PersonEstimator::create(site, estimation);
}

}  // namespace

Expected<void> check_kind(const Method& method, Kind kind) {
  const std::string name(method.name);
  if (kind == Kind::kDevice && method.create_device == nullptr) {
    return make_error(ErrorKind::kUsage, "--method " + name + " locates people; use --kind person");
  }
  if (kind == Kind::kPerson && method.create_person == nullptr) {
    return make_error(ErrorKind::kUsage,
                      "--method " + name + " locates devices; use --kind device");
  }
  return {};
}

Expected<Estimators> make_estimators(const EstimatorOptions& options,
                                     const Site& site,
                                     const std::shared_ptr<const Carried>& carried,
                                     const Observer& observer) {
  const Method& method = *options.method;
  RAYLOC_TRY(check_kind(method, options.kind));
  Estimators estimators;
  if (options.kind != Kind::kPerson && method.create_device != nullptr) {
    auto devices = make_device_estimator(options, site, carried);
    RAYLOC_TRY(devices);
    estimators.devices = *std::move(devices);
    estimators.all.add(*estimators.devices);
  }
  // Without a reference no person can be located; a request for people alone gets that error.
  if (options.kind == Kind::kPerson || estimators.devices == nullptr ||
      (options.kind == Kind::kAll && method.create_person != nullptr && site.reference_file)) {
    auto people = make_person_estimator(options, site, carried);
    RAYLOC_TRY(people);
    estimators.people = *std::move(people);
    estimators.all.add(*estimators.people);
  }
  const RoomModel& room =
      estimators.devices ? estimators.devices->room() : estimators.people->room();
  note_scene(*room.scene, observer);
  return estimators;
}

}  // namespace rayloc::replay
