// BurstLocator: locates the devices that sent the bursts of one batch: a snapshot of each burst
// where one is wanted, and the estimates of the tracks.
//
// Thread safety: for one thread, except channels().
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/device/chain_supervisor.h"
#include "daemon/pipeline/device/channel_watch.h"
#include "daemon/pipeline/device/device_results.h"
#include "daemon/pipeline/device/device_rooms.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/watch/stamp_check.h"

namespace rayloc {

// Bursts that are compared as a whole with the whole room, which a track does not need.
enum class Snapshots : std::uint8_t {
  kAlways,
  kAcquire,  // of devices that no track follows yet
};

// A device's burst that is being processed.
struct BurstWork {
  const Burst* burst = nullptr;
  Estimates* out = nullptr;
  const DeviceRoom* room = nullptr;
  std::size_t first = 0;  // index of its first location
  std::vector<CsiFrame> kept;
  std::span<const CsiFrame> frames;  // of the burst or of `kept`; empty: no access point is usable
  ChainTrust trust;
  std::vector<CalibrationWarning> warnings;
  bool has_snapshot = false;
};

class BurstLocator {
 public:
  // `chains` and `results` outlive this.
  BurstLocator(Snapshots snapshots, const ChainSupervisor& chains, DeviceResults& results)
      : snapshots_(snapshots), chains_(chains), results_(results) {}

  // Selects the frames to be tracked, and appends the snapshot if one is wanted now. To be called
  // in the order of the bursts.
  void begin(BurstWork& work);
  // Passes the bursts of a batch to their tracks, and appends the results to each burst's output.
  void track(std::span<BurstWork> works, const std::vector<DeviceRoom>& rooms);
  // Appends a result without position for a burst whose time stamps are wrong.
  void refuse(const Burst& burst, const StuckStamp& stamp, const RoomModel& room, Estimates& out);

  ChannelWatch& channels() { return channels_; }  // from any thread

 private:
  void snapshot(BurstWork& work);
  void append(const std::vector<DeviceUpdate>& updates, BurstWork& work);
  void show_channel(const BurstWork& work);

  const Snapshots snapshots_;
  const ChainSupervisor& chains_;
  DeviceResults& results_;
  ChannelWatch channels_;
};

}  // namespace rayloc
