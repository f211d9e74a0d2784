// A DeviceMethod with tracks and chains that a test controls, and a site and its rooms for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method.h"
#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/device/device_rooms.h"
#include "engine/chains/chain_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::test {

class FakeTracks : public TrackCapability {
 public:
  std::vector<std::vector<DeviceUpdate>> track(std::span<const ReceivedBurst> bursts) override {
    std::vector<std::vector<DeviceUpdate>> updates;
    for (const ReceivedBurst& received : bursts) {
      frames.push_back(received.burst.frames.size());
      devices.insert(received.burst.device);
      DeviceUpdate update;
      update.device = received.burst.device;
      update.estimate.location.time = received.burst.frames.back().time;
      updates.emplace_back(reports ? 1U : 0U, update);
    }
    return updates;
  }
  // An estimate of each device that was received and does not wait.
  void advance(Timestamp now,
               std::vector<DeviceUpdate>& updates,
               const DeviceTracker::IsWaiting& is_waiting) override {
    for (const MacAddress& device : devices) {
      if (!is_waiting(device)) {
        DeviceUpdate& update = updates.emplace_back();
        update.device = device;
        update.estimate.location.time = now;
      }
    }
  }
  void restart(const std::string&, std::vector<DeviceUpdate>&) override {}
  bool has_track(const MacAddress&) const override { return is_followed; }
  bool follows(const MacAddress&) const override { return is_followed; }
  Timestamp received_until(Timestamp now) const override { return now; }
  TrackerCounters tracker_counters() const override { return {}; }

  bool is_followed = false;
  bool reports = true;              // an estimate for each burst
  std::vector<std::size_t> frames;  // of each burst
  std::set<MacAddress> devices;     // of all bursts
};

class FakeChains : public ChainCapability {
 public:
  void receive(std::span<const CsiFrame>) override {
    ++received;
    counted += counts ? 1U : 0U;
  }
  void receive_at(const Vec3d& place, std::span<const CsiFrame>) override {
    places.push_back(place);
  }
  std::vector<CsiFrame> accepted(std::span<const CsiFrame> frames) const override {
    return {frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(accepts)};
  }
  std::vector<CsiFrame> undone(std::span<const CsiFrame> frames) const override {
    std::vector<CsiFrame> all(frames.begin(), frames.end());
    if (learned) {
      undo(*learned, make_room().access_points[learned->access_point], all);
    }
    return all;
  }
  bool leaves_alone() const override { return !is_learning && !learned; }
  ChainTrust trust(std::span<const CsiFrame>) const override { return {fault, 3}; }
  LocationEstimate locate_coarsely(std::span<const CsiFrame>) const override { return coarse; }
  std::vector<ChainState> states() const override {
    if (learned) {
      return {*learned};
    }
    ChainState state;
    state.knowledge = is_learning ? ChainKnowledge::kLearning : ChainKnowledge::kAsCalibrated;
    return {state};
  }
  std::optional<ChainRecord> record(std::size_t) const override { return evidence; }
  std::uint64_t changes() const override { return counted + (is_learning ? 1U : 0U); }
  void adopt(const ChainState& state) override { adopted.push_back(state); }
  void restore(const ChainState& state) override { restored.push_back(state); }
  void power_cycled(std::size_t, Timestamp) override { ++power_cycles; }
  void restart() override { ++restarts; }

  bool is_learning = false;
  std::optional<ChainState> learned;
  int power_cycles = 0;
  FrameFault fault;     // of each burst
  bool counts = false;  // the bursts of devices
  std::uint64_t counted = 0;
  std::size_t accepts = 0;  // frames of a burst while chains are being learned
  LocationEstimate coarse;
  std::optional<ChainRecord> evidence;
  int received = 0;
  int restarts = 0;
  std::vector<Vec3d> places;
  std::vector<ChainState> adopted;
  std::vector<ChainState> restored;
};

class FakeDevices : public DeviceMethod {
 public:
  explicit FakeDevices(std::shared_ptr<const RoomModel> room) : room_(std::move(room)) {}

  const RoomModel& room() const override { return *room_; }
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t) const override {
    LocationEstimate estimate;
    estimate.reason = std::to_string(frames.size()) + " frames";
    return estimate;
  }
  TrackCapability* tracks() override { return has_tracks ? &fake_tracks : nullptr; }
  ChainCapability* chains() override { return has_chains ? &fake_chains : nullptr; }

  bool has_tracks = true;
  bool has_chains = true;
  FakeTracks fake_tracks;
  FakeChains fake_chains;

 private:
  std::shared_ptr<const RoomModel> room_;
};

inline Expected<std::unique_ptr<DeviceMethod>> make_fake_devices(DeviceMethodInput input) {
  return std::make_unique<FakeDevices>(std::move(input.room));
}
inline constexpr Method kFakeDevices = {
    .name = "fake", .summary = "", .domain = "", .create_device = &make_fake_devices};

// A site with unlisted devices and one listed at another height: two rooms.
class FakeRooms {
 public:
  FakeRooms() : rooms(site) {
    site.name = "hall";
    site.transmitters.emplace_back().height = 0.5;
    EXPECT_TRUE(rooms.prepare(kFakeDevices, {}, make_room()));
  }

  FakeDevices& method(std::size_t room = 0) const {
    return dynamic_cast<FakeDevices&>(*rooms.all()[room].method);
  }

  Site site;
  DeviceRooms rooms;
};

// `count` frames of an unlisted device, 100 ms apart from `first` on.
inline Burst burst_of(std::size_t count, Timestamp first) {
  Burst burst;
  burst.transmitter = {{0x02, 0, 0, 0, 0, 9}};
  burst.frames.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    burst.frames[i].transmitter = burst.transmitter;
    burst.frames[i].time = first + static_cast<int>(i) * std::chrono::milliseconds(100);
  }
  burst.first = burst.received_since = first;
  burst.last = burst.frames.back().time;
  return burst;
}

}  // namespace rayloc::test
