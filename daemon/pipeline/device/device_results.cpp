#include "daemon/pipeline/device/device_results.h"

#include <utility>

#include "daemon/messages/topic.h"

namespace rayloc {

Target DeviceResults::target_of(const MacAddress& device, Timestamp time) const {
  Target target;
  target.address = options_.names->text(device, time);
  target.is_hashed = options_.names->hashed();
  // A name would permanently disclose the address that the hash hides.
  const SiteTransmitter* stated = find_transmitter(site_, device);
  if (stated != nullptr && !target.is_hashed) {
    target.name = stated->name;
  }
  return target;
}

LocationContext DeviceResults::context_of(const RoomModel& room) const {
  LocationContext context;
  context.site = site_.name;
  context.scene_hash = room.scene_hash;
  context.calibration_id = room.calibration_id;
  context.method = options_.method;
  context.valid_for = options_.valid_for;
  return context;
}

void DeviceResults::append(LocationEstimate snapshot,
                           const MacAddress& device,
                           const RoomModel& room,
                           Estimates& out) const {
  Target target = target_of(device, snapshot.time);
  out.locations.push_back({std::move(snapshot), std::move(target), context_of(room)});
}

void DeviceResults::append(const std::vector<DeviceUpdate>& updates,
                           const RoomModel& room,
                           Estimates& out) {
  for (const DeviceUpdate& update : updates) {
    const FilteredEstimate& estimate = update.estimate;
    Target target = target_of(update.device, estimate.location.time);
    const Timestamp time = estimate.location.time;
    target.track = numbers_.of(update.device, target_component(target), time);
    if (estimate.transition) {
      out.events.push_back({target, *estimate.transition, estimate.location.position});
    }
    out.locations.push_back(filtered_location(estimate, std::move(target), context_of(room)));
    if (estimate.state == TrackState::kLost) {
      numbers_.lost(update.device, time);
    }
  }
}

}  // namespace rayloc
