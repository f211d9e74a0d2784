// SiteEstimators: the estimators of one site: those of its method, its zones over them, and the
// methods that are compared with it.
//
// Thread safety: one thread (main), unless stated otherwise.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "daemon/live/config/config.h"
#include "daemon/messages/target_names.h"
#include "daemon/pipeline/compare/compared_estimator.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/person_estimator.h"
#include "daemon/pipeline/zones/zone_estimator.h"
#include "engine/base/expected.h"

namespace rayloc {

class SiteEstimators {
 public:
  struct Options {
    std::shared_ptr<PathGridStore> path_grids;  // null: traced rooms are not stored
    std::shared_ptr<TargetNames> names;
    std::string chain_file;  // for chains learned by the site's method; empty: not stored
  };

  // Reads the scene and prepares the room. `setup` outlives it.
  static Expected<std::unique_ptr<SiteEstimators>> create(const SiteSetup& setup, Options options);
  SiteEstimators(const SiteEstimators&) = delete;
  SiteEstimators& operator=(const SiteEstimators&) = delete;

  // Makes them continue from a predecessor, before they have had a burst.
  Expected<void> go_on(const std::shared_ptr<const Carried>& before);

  // The estimator of the site. It locates no target with method "none".
  Estimator& estimator();
  DeviceEstimator* devices() const { return devices_.get(); }  // null: no devices are located
  PersonEstimator* people() const { return people_.get(); }    // null: no people are
  const RoomModel* room() const;                               // null: no target is located

  std::span<const std::unique_ptr<ComparedMethod>> compared() const { return compared_; }
  void stop_compared();

 private:
  SiteEstimators(const SiteSetup& setup, Options options);
  Expected<std::unique_ptr<DeviceEstimator>> make_devices(const Method& method) const;
  Expected<std::unique_ptr<PersonEstimator>> make_people(
      const Method& method, const std::shared_ptr<const Carried>& before) const;
  // The estimators of a method, null for the kind that it or the site does not have.
  struct Both {
    std::unique_ptr<DeviceEstimator> devices;
    std::unique_ptr<PersonEstimator> people;
  };
  Expected<Both> make_both(const Method& method) const;
  Expected<std::unique_ptr<ComparedMethod>> make_compared(const Method& method) const;
  MethodOptions settings_of(const Method& method) const;
  void assemble(const Carried* before);

  const SiteSetup& setup_;
  const Options options_;
  std::unique_ptr<DeviceEstimator> devices_;
  std::unique_ptr<PersonEstimator> people_;  // null without a reference of the empty room
  EstimatorList list_;                       // both
  std::unique_ptr<ZoneEstimator> zones_;     // over them
  std::vector<std::unique_ptr<ComparedMethod>> compared_;
  std::unique_ptr<ComparedEstimator> with_others_;  // over the zones; null with one method
};

}  // namespace rayloc
