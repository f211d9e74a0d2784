// DeviceMethod: a method instance in one room, for devices of one height and antenna.
//
// Every method must implement locate(). Tracks, learning of the chains and a channel model are
// optional capabilities (device_capabilities.h); a method without one keeps the default.
//
// Thread safety: single-threaded.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <span>

#include "daemon/methods/device_capabilities.h"
#include "daemon/methods/method_options.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct Training;

struct DeviceMethodInput {
  std::shared_ptr<const RoomModel> room;
  MethodOptions options;
  std::set<MacAddress> listed = {};  // devices listed in the site: never refused a track
  std::shared_ptr<const Training> training = nullptr;  // for this method; null: untrained
};

class DeviceMethod {
 public:
  virtual ~DeviceMethod() = default;

  virtual const RoomModel& room() const = 0;

  // `frames`: from one device, any access points, in order of time. `repeat`: another number gives
  // other random draws, for studies; a method without random draws ignores it.
  virtual LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat) const = 0;

  // Optional capabilities, which exist as long as the method; null: the method has none.
  virtual TrackCapability* tracks() { return nullptr; }
  virtual ChainCapability* chains() { return nullptr; }  // null: frames are used unchanged
  // Viewers may keep it longer than the method.
  virtual std::shared_ptr<const ChannelCapability> channel() const { return nullptr; }

 protected:
  DeviceMethod() = default;
  DeviceMethod(const DeviceMethod&) = default;
  DeviceMethod& operator=(const DeviceMethod&) = default;
};

}  // namespace rayloc
