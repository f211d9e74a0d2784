// DeviceMethod: a method at work in one room, on devices of one height and antenna.
//
// locate() is all that a method must have. Tracks, a watch on the chains and a model of the channel
// are of methods that have them; the others leave these members as they are.
//
// Thread safety: for one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "daemon/methods/method_options.h"
#include "engine/chains/chain_learner.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"
#include "engine/track/device_tracker.h"

namespace rayloc {

struct Training;

struct DeviceMethodInput {
  std::shared_ptr<const RoomModel> room;
  MethodOptions options;
  std::set<MacAddress> listed = {};  // devices that the site names: never refused a track
  std::shared_ptr<const Training> training = nullptr;  // of this method; null: nothing was learned
};

// What a method thought of the chains of a burst's frames when they were heard.
struct ChainTrust {
  FrameDoubt doubt;
  std::uint64_t withdrawals = 0;  // ChainLearner::withdrawals()
};

// A burst for a track, doubted as its frames were when they were heard.
struct HeardBurst {
  DeviceBurst burst;
  std::uint64_t withdrawals = 0;  // ChainTrust::withdrawals
};

class DeviceMethod {
 public:
  virtual ~DeviceMethod() = default;

  virtual const RoomModel& room() const = 0;

  // `frames`: of one device, any access points, in order of time. `repeat`: another number, other
  // random draws, for studies; a method that draws nothing leaves it alone.
  virtual LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat) const = 0;

  // Whether its devices get tracks.
  virtual bool has_tracks() const { return false; }
  // Tracks, as DeviceTracker has them: [burst]. REQUIRES: every burst is of another device.
  virtual std::vector<std::vector<DeviceUpdate>> track(std::span<const HeardBurst> bursts) {
    return std::vector<std::vector<DeviceUpdate>>(bursts.size());
  }
  virtual void advance(Timestamp /*now*/, std::vector<DeviceUpdate>& /*updates*/) {}
  virtual void restart(const std::string& /*reason*/, std::vector<DeviceUpdate>& /*updates*/) {}
  // Whether the device has a track, and one that was confirmed.
  virtual bool knows(const MacAddress& /*device*/) const { return false; }
  virtual bool follows(const MacAddress& /*device*/) const { return false; }
  // When the device that has been silent longest of those with a track was heard; `now` without
  // any.
  virtual Timestamp heard_until(Timestamp now) const { return now; }
  virtual TrackerCounters tracker_counters() const { return {}; }

  // Receive chains learned from devices; null: frames are taken as they come.
  virtual ChainLearner* chains() { return nullptr; }
  // To be asked when `believed` frames have been heard, before those of anybody else are.
  virtual ChainTrust trust(std::span<const CsiFrame> /*believed*/) const { return {}; }

  // What explains the channel behind a position to those who look at it; null: nothing does.
  virtual std::shared_ptr<const Localizer> localizer() const { return nullptr; }

 protected:
  DeviceMethod() = default;
  DeviceMethod(const DeviceMethod&) = default;
  DeviceMethod& operator=(const DeviceMethod&) = default;
};

}  // namespace rayloc
