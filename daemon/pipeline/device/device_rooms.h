// DeviceRooms: the instances of the method that locates devices, one for each device model (height
// and antenna) that the site states.
//
// Thread safety: for one thread, except first(), which any thread may call after prepare().
#pragma once

#include <memory>
#include <vector>

#include "daemon/methods/device_method.h"
#include "daemon/methods/method.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

// The room as one device model sees it.
struct DeviceRoom {
  DeviceModel device;
  std::unique_ptr<DeviceMethod> method;

  const RoomModel& room() const { return method->room(); }
};

class DeviceRooms {
 public:
  explicit DeviceRooms(const Site& site) : site_(site) {}  // outlives this

  // Makes the instances: seconds, since each device model needs rays of its own. To be called once,
  // before the other members. kConfiguration if the site has no device to locate.
  Expected<void> prepare(const Method& method, const MethodOptions& settings, RoomModel room);

  // Room of a device; `stated`: its entry in the site, null for an unlisted one. REQUIRES: the site
  // wants it located.
  const DeviceRoom& of(const SiteTransmitter* stated) const;

  const std::vector<DeviceRoom>& all() const { return rooms_; }
  // The room of unlisted devices, if these are located.
  const RoomModel& first() const { return rooms_.front().room(); }

  // Those of the rooms whose method learns chains.
  std::vector<ChainCapability*> learners() const;
  bool has_track(const MacAddress& device) const;
  // Last reception from the longest silent device with a track; `now` if no device has one.
  Timestamp received_until(Timestamp now) const;
  TrackerCounters tracker_counters() const;  // sum over the rooms

 private:
  DeviceModel device_of(const SiteTransmitter* stated) const;
  std::vector<DeviceModel> devices() const;
  Expected<void> add(const Method& method,
                     const MethodOptions& settings,
                     std::shared_ptr<const RoomModel> room);

  const Site& site_;
  std::vector<DeviceRoom> rooms_;  // not empty once it is prepared
};

}  // namespace rayloc
