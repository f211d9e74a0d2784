#include "daemon/pipeline/device/device_rooms.h"

#include <algorithm>
#include <utility>

#include "daemon/pipeline/method_training.h"
#include "daemon/site/model/room_model.h"

namespace rayloc {

DeviceModel DeviceRooms::device_of(const SiteTransmitter* stated) const {
  return stated == nullptr ? unlisted_device(site_) : device_model(*stated);
}

// Each device model to be located once.
std::vector<DeviceModel> DeviceRooms::devices() const {
  std::vector<DeviceModel> devices;
  if (site_.targets.track_unlisted) {
    devices.push_back(device_of(nullptr));
  }
  for (const SiteTransmitter& transmitter : site_.transmitters) {
    const DeviceModel device = device_of(&transmitter);
    if (transmitter.role == TransmitterRole::kDevice &&
        std::find(devices.begin(), devices.end(), device) == devices.end()) {
      devices.push_back(device);
    }
  }
  return devices;
}

Expected<void> DeviceRooms::add(const Method& method,
                                const MethodOptions& settings,
                                std::shared_ptr<const RoomModel> room) {
  const DeviceModel device = room->device;
  DeviceMethodInput input{std::move(room), settings};
  for (const SiteTransmitter& transmitter : site_.transmitters) {
    input.listed.insert(transmitter.mac);
  }
  auto training = training_of(site_, method, *input.room);
  RAYLOC_TRY(training);
  input.training = *std::move(training);
  auto made = method.create_device(std::move(input));
  RAYLOC_TRY(made);
  rooms_.push_back({device, *std::move(made)});
  return {};
}

Expected<void> DeviceRooms::prepare(const Method& method,
                                    const MethodOptions& settings,
                                    RoomModel room) {
  const std::vector<DeviceModel> models = devices();
  if (models.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      (site_.directory / "site.toml").string() +
                          ": no device to locate: add a [[transmitter]] with role = \"device\", or "
                          "set unlisted = \"track\" in [targets]");
  }
  for (const DeviceModel& model : models) {
    room.device = model;
    RAYLOC_TRY(add(method, settings, std::make_shared<const RoomModel>(room)));
  }
  return {};
}

const DeviceRoom& DeviceRooms::of(const SiteTransmitter* stated) const {
  const DeviceModel device = device_of(stated);
  return *std::find_if(rooms_.begin(), rooms_.end(), [&](const DeviceRoom& candidate) {
    return candidate.device == device;
  });
}

std::vector<ChainCapability*> DeviceRooms::learners() const {
  std::vector<ChainCapability*> all;
  for (const DeviceRoom& room : rooms_) {
    if (ChainCapability* learner = room.method->chains()) {
      all.push_back(learner);
    }
  }
  return all;
}

bool DeviceRooms::has_track(const MacAddress& device) const {
  return std::any_of(rooms_.begin(), rooms_.end(), [&](const DeviceRoom& room) {
    const TrackCapability* tracks = room.method->tracks();
    return tracks != nullptr && tracks->has_track(device);
  });
}

Timestamp DeviceRooms::received_until(Timestamp now) const {
  Timestamp earliest = now;
  for (const DeviceRoom& room : rooms_) {
    if (const TrackCapability* tracks = room.method->tracks()) {
      earliest = std::min(earliest, tracks->received_until(now));
    }
  }
  return earliest;
}

TrackerCounters DeviceRooms::tracker_counters() const {
  TrackerCounters sum;
  for (const DeviceRoom& room : rooms_) {
    if (const TrackCapability* tracks = room.method->tracks()) {
      sum += tracks->tracker_counters();
    }
  }
  return sum;
}

}  // namespace rayloc
