// DeviceEstimator: locates the transmitters that the site wants located (device-based): those
// listed with role "device" and, unless the site disables it, unlisted ones. Each burst gives a
// snapshot, and filtered estimates of the instants within it.
//
// The cores share the tracks of different devices. Chains are learned burst by burst in order, so
// that no result depends on which bursts are processed together. A burst whose predecessors had to
// be left out contributes its last instant only, and gives a snapshot only where no track reports:
// under overload, all devices keep an estimate and lose the instants between.
//
// Bursts of fixed transmitters give no location here; they show whether the calibration is still
// valid (CalibrationMonitor), and the result is stated in the warnings of every location. Receive
// chains whose phases have changed are learned from devices (ChainCapability); an access point is
// not used until its chains are learned again. Estimators that follow in the list get the state of
// the chains with the burst (Estimates::chains).
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/messages/target_names.h"
#include "daemon/methods/method_registry.h"
#include "daemon/pipeline/device/burst_locator.h"
#include "daemon/pipeline/device/calibration_warnings.h"
#include "daemon/pipeline/device/chain_supervisor.h"
#include "daemon/pipeline/device/device_results.h"
#include "daemon/pipeline/device/device_rooms.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/watch/dead_chains.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc {

class DeviceEstimator : public Estimator {
 public:
  struct Options {
    const Method* method = &default_method();  // the method that locates devices
    MethodOptions settings;
    Duration valid_for = std::chrono::milliseconds(450);  // until a next burst is overdue
    // Names of devices; null: named by their addresses.
    std::shared_ptr<TargetNames> names;
    ChainKeeper::Options chains;
    Snapshots snapshots = Snapshots::kAlways;
    std::shared_ptr<const Carried> before;  // state of the predecessor; null: none
  };

  // Reads the scene and prepares the room: seconds. Devices of different height or antenna each
  // need a separate room.
  static Expected<std::unique_ptr<DeviceEstimator>> create(const Site& site,
                                                           const Options& options);

  void estimate(const Burst& burst, Estimates& out) override {
    estimate_each({&burst, 1}, {&out, 1});
  }
  void estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) override;

  void advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) override;

  void restart(const std::string& reason, Estimates& out) override;

  void carry(Carried& carried) const override;
  // The same as Options::before, for an estimator that has not received any burst yet.
  void go_on(const Carried& before);

  Rank rank(const MacAddress& transmitter) const override;

  // Warnings that hold now. Thread safety: these may be called from any thread.
  std::vector<CalibrationWarning> calibration_warnings() const { return warnings_.now(); }
  // Current chain states, and changes for the log since the last call. From any
  // thread.
  std::vector<ChainState> chain_states() const { return chains_.states(); }
  std::vector<std::string> chain_notices() { return chains_.notices(); }
  // Progress of the chains that are being learned; empty if there are none.
  std::string chain_progress() const { return chains_.reason(room()); }
  TrackerCounters tracker_counters() const;  // sum over all trackers

  // Channels of devices, by a method with a ChannelCapability.
  ChannelWatch& channels() { return locator_.channels(); }

  const RoomModel& room() const { return rooms_.first(); }

 private:
  DeviceEstimator(Site site, Options options);
  std::optional<BurstWork> receive(const Burst& burst, Estimates& out);
  void update_warnings();
  void publish_counters();

  const Site site_;
  const Options options_;
  // Used by the estimation thread, except the members that any thread may call.
  DeviceRooms rooms_;
  ChainSupervisor chains_;
  DeadChains dead_chains_;
  CalibrationWarnings warnings_;
  DeviceResults results_;
  BurstLocator locator_;
  mutable std::mutex mutex_;
  TrackerCounters tracker_counters_;  // guarded by mutex_
};

}  // namespace rayloc
