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
// chains whose phases have changed are learned from devices (ChainLearner); an access point is not
// used until its chains are learned again.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/messages/location.h"
#include "daemon/messages/target_names.h"
#include "daemon/methods/device_method.h"
#include "daemon/methods/method_registry.h"
#include "daemon/pipeline/chain_keeper.h"
#include "daemon/pipeline/channel_watch.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/track_numbers.h"
#include "daemon/pipeline/watch/dead_chains.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/monitor/calibration_monitor.h"

namespace rayloc {

// Bursts that are compared as a whole with the whole room, which a track does not need.
enum class Snapshots : std::uint8_t {
  kAlways,
  kAcquire,  // of devices that no track follows yet
};

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

  void advance(Timestamp time, Estimates& out) override;

  void restart(const std::string& reason, Estimates& out) override;

  void carry(Carried& carried) const override;
  // The same as Options::before, for an estimator that has not received any burst yet.
  void go_on(const Carried& before);

  Rank rank(const MacAddress& transmitter) const override;

  // Warnings that hold now. Thread safety: these may be called from any thread.
  std::vector<CalibrationWarning> calibration_warnings() const;
  // Current chain states, and changes for the log since the last call. From any
  // thread.
  std::vector<ChainState> chain_states() const { return chains_.states(); }
  std::vector<std::string> chain_notices() { return chains_.notices(); }
  // Progress of the chains that are being learned; empty if there are none.
  std::string chain_progress() const { return chains_.reason(room()); }
  TrackerCounters tracker_counters() const;  // sum over all trackers

  ChannelWatch& channels() { return channels_; }  // of devices, by a method with a Localizer

  const RoomModel& room() const { return rooms_.front().room(); }

 private:
  struct Room {
    DeviceModel device;
    std::unique_ptr<DeviceMethod> method;

    const RoomModel& room() const { return method->room(); }
  };

  // A device's burst that is being processed.
  struct Work {
    const Burst* burst = nullptr;
    Estimates* out = nullptr;
    Room* room = nullptr;
    std::size_t first = 0;  // index of its first location
    std::vector<CsiFrame> kept;
    std::span<const CsiFrame> frames;  // of the burst or of `kept`
    ChainTrust trust;
    std::vector<CalibrationWarning> warnings;
    bool has_snapshot = false;
  };

  DeviceEstimator(Site site, Options options);
  Expected<Room> prepare(std::shared_ptr<const RoomModel> room) const;
  Expected<void> watch_calibration(const RoomModel& room);
  std::optional<Work> receive(const Burst& burst, Estimates& out);
  void track(std::vector<Work>& works);
  void state(Work& work, const std::vector<DeviceUpdate>& updates);
  LocationEstimate coarse_estimate(const Work& work) const;
  void snapshot(Work& work);
  void check_calibration(const SiteTransmitter& fixed, const Burst& burst);
  std::span<const CsiFrame> accepted(const Burst& burst, Room& room, std::vector<CsiFrame>& kept);
  std::vector<ChainLearner*> learners() const;
  void state_warnings();
  DeviceModel device_of(const SiteTransmitter* stated) const;
  void show_channel(std::span<const CsiFrame> frames, const Room& room, const Location& location);
  Target target_of(const MacAddress& device, Timestamp time) const;
  LocationContext context_of(const Room& room) const;
  void append(const std::vector<DeviceUpdate>& updates, const Room& room, Estimates& out);
  void publish_counters();

  const Site site_;
  const Options options_;
  std::vector<Room> rooms_;                      // the first is that of unlisted devices
  std::unique_ptr<CalibrationMonitor> monitor_;  // used by the estimation thread
  ChainKeeper chains_;      // used by the estimation thread, except its notices
  DeadChains dead_chains_;  // used by the estimation thread
  ChannelWatch channels_;
  mutable std::mutex mutex_;
  std::vector<CalibrationWarning> warnings_;  // guarded by mutex_
  TrackerCounters tracker_counters_;          // guarded by mutex_
  // Used by the estimation thread.
  TrackNumbers numbers_;
  std::map<MacAddress, Timestamp> watched_;         // last frame of each fixed transmitter
  std::map<MacAddress, Timestamp> watched_before_;  // the same of the predecessor
};

}  // namespace rayloc
