// DeviceMethod: a method instance in one room, for devices of one height and antenna.
//
// Every method must implement locate(). Tracks, monitoring of the chains and a channel model are
// optional; methods without them keep the defaults of these members.
//
// Thread safety: single-threaded.
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
  std::set<MacAddress> listed = {};  // devices listed in the site: never refused a track
  std::shared_ptr<const Training> training = nullptr;  // for this method; null: untrained
};

// A method's assessment of the chains of a burst's frames at the time of reception.
struct ChainTrust {
  FrameFault chain_fault;
  std::uint64_t withdrawals = 0;  // ChainLearner::withdrawals()
};

// A burst for a track, with the chain assessment made at the reception of its frames.
struct ReceivedBurst {
  DeviceBurst burst;
  std::uint64_t withdrawals = 0;  // ChainTrust::withdrawals
};

class DeviceMethod {
 public:
  virtual ~DeviceMethod() = default;

  virtual const RoomModel& room() const = 0;

  // `frames`: from one device, any access points, in order of time. `repeat`: another number gives
  // other random draws, for studies; a method without random draws ignores it.
  virtual LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat) const = 0;

  // True if its devices get tracks.
  virtual bool has_tracks() const { return false; }
  // Tracks, as in DeviceTracker: [burst]. REQUIRES: every burst is from another device.
  virtual std::vector<std::vector<DeviceUpdate>> track(std::span<const ReceivedBurst> bursts) {
    return std::vector<std::vector<DeviceUpdate>>(bursts.size());
  }
  virtual void advance(Timestamp /*now*/, std::vector<DeviceUpdate>& /*updates*/) {}
  virtual void restart(const std::string& /*reason*/, std::vector<DeviceUpdate>& /*updates*/) {}
  // True if the device has a track; follows(): if the track is confirmed.
  virtual bool has_track(const MacAddress& /*device*/) const { return false; }
  virtual bool follows(const MacAddress& /*device*/) const { return false; }
  // Last reception from the longest silent device
  // that has a track; `now` if no device has one.
  virtual Timestamp received_until(Timestamp now) const { return now; }
  virtual TrackerCounters tracker_counters() const { return {}; }

  // Receive chains learned from devices; null: frames are used unchanged.
  virtual ChainLearner* chains() { return nullptr; }
  // Must be called after `accepted` frames were received, before other frames are processed.
  virtual ChainTrust trust(std::span<const CsiFrame> /*accepted*/) const { return {}; }

  // The channel model behind a position, for viewers; null: the method has none.
  virtual std::shared_ptr<const Localizer> localizer() const { return nullptr; }

 protected:
  DeviceMethod() = default;
  DeviceMethod(const DeviceMethod&) = default;
  DeviceMethod& operator=(const DeviceMethod&) = default;
};

}  // namespace rayloc
