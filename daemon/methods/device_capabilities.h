// Optional capabilities of a DeviceMethod: tracks, receive chains that are learned from devices,
// and a channel model for viewers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/chains/chain_record.h"
#include "engine/chains/chain_state.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/localize/array_observation.h"
#include "engine/localize/localizer.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"
#include "engine/track/device_tracker.h"

namespace rayloc {

// A method's assessment of the chains of a burst's frames at the time of reception.
struct ChainTrust {
  FrameFault chain_fault;
  // Number of times that frames accepted before turned out to be wrong: all estimates from them may
  // be wrong.
  std::uint64_t withdrawals = 0;
};

// A burst for a track, with the chain assessment made at the reception of its frames.
struct ReceivedBurst {
  DeviceBurst burst;
  std::uint64_t withdrawals = 0;  // ChainTrust::withdrawals
};

// The devices get tracks. Thread safety: single-threaded.
class TrackCapability {
 public:
  virtual ~TrackCapability() = default;

  // As in DeviceTracker: [burst]. REQUIRES: every burst is from another device.
  virtual std::vector<std::vector<DeviceUpdate>> track(std::span<const ReceivedBurst> bursts) = 0;
  virtual void advance(Timestamp now,
                       std::vector<DeviceUpdate>& updates,
                       const DeviceTracker::IsWaiting& is_waiting) = 0;
  virtual void restart(const std::string& reason, std::vector<DeviceUpdate>& updates) = 0;
  // True if the device has a track; follows(): if the track is confirmed.
  virtual bool has_track(const MacAddress& device) const = 0;
  virtual bool follows(const MacAddress& device) const = 0;
  // Last reception from the longest silent device that has a track; `now` if no device has one.
  virtual Timestamp received_until(Timestamp now) const = 0;
  virtual TrackerCounters tracker_counters() const = 0;

 protected:
  TrackCapability() = default;
  TrackCapability(const TrackCapability&) = default;
  TrackCapability& operator=(const TrackCapability&) = default;
};

// Changed receive chains are learned from the bursts, as in ChainLearner. Thread safety:
// single-threaded.
class ChainCapability {
 public:
  virtual ~ChainCapability() = default;

  // A burst of a device anywhere in the area, as the radios delivered it, in order of time;
  // receive_at(): of a transmitter at a known place [m].
  virtual void receive(std::span<const CsiFrame> frames) = 0;
  virtual void receive_at(const Vec3d& place, std::span<const CsiFrame> frames) = 0;

  // The frames of the access points with known chains, corrected to the calibration; undone(): of
  // all access points.
  virtual std::vector<CsiFrame> accepted(std::span<const CsiFrame> frames) const = 0;
  virtual std::vector<CsiFrame> undone(std::span<const CsiFrame> frames) const = 0;
  // True if accepted() and undone() would change nothing.
  virtual bool leaves_alone() const = 0;
  // Must be called after `accepted` frames were received, before other frames are processed.
  virtual ChainTrust trust(std::span<const CsiFrame> accepted) const = 0;
  // Position of a device without the phases of the antennas, for a burst whose access points are
  // all left out. Without a position `reason` states the cause.
  virtual LocationEstimate locate_coarsely(std::span<const CsiFrame> frames) const = 0;

  // In order of access points, for those with received frames or a restored state.
  virtual std::vector<ChainState> states() const = 0;
  // Evidence on the chains of an access point that are being learned; empty without evidence.
  virtual std::optional<ChainRecord> record(std::size_t access_point) const = 0;
  virtual std::uint64_t changes() const = 0;  // equal counts mean equal states
  // Replaces a state by one that another instance found; restore(): by one of an earlier
  // run, with its evidence (ChainState::record), which outlives restart().
  virtual void adopt(const ChainState& state) = 0;
  virtual void restore(const ChainState& state) = 0;
  // The access point was powered off: its chains have probably changed.
  virtual void power_cycled(std::size_t access_point, Timestamp time) = 0;
  // After a seek in a recording: restored states hold again.
  virtual void restart() = 0;

 protected:
  ChainCapability() = default;
  ChainCapability(const ChainCapability&) = default;
  ChainCapability& operator=(const ChainCapability&) = default;
};

// The channel model behind the positions, for viewers. Thread safety: any thread.
class ChannelCapability {
 public:
  virtual ~ChannelCapability() = default;

  virtual const RoomModel& room() const = 0;
  // The channels of one burst as they are compared with the room. The result is valid as long as
  // this exists.
  virtual RoomObservation receive(std::span<const CsiFrame> frames) const = 0;

 protected:
  ChannelCapability() = default;
  ChannelCapability(const ChannelCapability&) = default;
  ChannelCapability& operator=(const ChannelCapability&) = default;
};

}  // namespace rayloc
