#include "daemon/pipeline/device_estimator.h"

#include <algorithm>
#include <utility>

#include "daemon/publish/location_message.h"
#include "daemon/site/room_model.h"

namespace rayloc {

const RoomModel& DeviceEstimator::Room::room() const {
  return std::visit([](const auto& of) -> const RoomModel& { return of.room(); }, localizer);
}

LocationEstimate DeviceEstimator::Room::locate(std::span<const CsiFrame> frames) const {
  return std::visit([&](const auto& of) { return of.locate(frames); }, localizer);
}

Expected<DeviceEstimator::Room> DeviceEstimator::prepare(
    std::shared_ptr<const RoomModel> room) const {
  const DeviceModel device = room->device;
  const auto held = [&](auto localizer) -> Expected<Room> {
    if (!localizer) {
      return tl::make_unexpected(localizer.error());
    }
    return Room{device, *std::move(localizer)};
  };
  return options_.method == LocationMethod::kPaper
             ? held(PaperLocalizer::create(std::move(room), options_.paper))
             : held(Localizer::create(std::move(room), options_.localizer));
}

DeviceModel DeviceEstimator::device_of(const SiteTransmitter* stated) const {
  DeviceModel device;
  if (stated == nullptr) {
    device.height = site_.targets.height;
    return device;
  }
  device.height = stated->height;
  device.pattern = stated->pattern;
  device.polarization = stated->polarization;
  return device;
}

Expected<std::unique_ptr<DeviceEstimator>> DeviceEstimator::create(const Site& site,
                                                                   const Options& options) {
  std::unique_ptr<DeviceEstimator> estimator(new DeviceEstimator(site, options));
  Expected<RoomModel> room = load_room_model(site);
  if (!room) {
    return tl::make_unexpected(room.error());
  }
  std::vector<DeviceModel> devices;
  if (site.targets.track_unlisted) {
    devices.push_back(estimator->device_of(nullptr));
  }
  for (const SiteTransmitter& transmitter : site.transmitters) {
    const DeviceModel device = estimator->device_of(&transmitter);
    if (transmitter.role == TransmitterRole::kDevice &&
        std::find(devices.begin(), devices.end(), device) == devices.end()) {
      devices.push_back(device);
    }
  }
  if (devices.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      (site.directory / "site.toml").string() +
                          ": no device to locate: add a [[transmitter]] with role = \"device\", or "
                          "set unlisted = \"track\" in [targets]");
  }
  for (const DeviceModel& device : devices) {
    room->device = device;
    Expected<Room> prepared = estimator->prepare(std::make_shared<const RoomModel>(*room));
    if (!prepared) {
      return tl::make_unexpected(prepared.error());
    }
    estimator->rooms_.push_back(*std::move(prepared));
  }
  return estimator;
}

void DeviceEstimator::estimate(const Burst& burst, std::vector<v1::Location>& out) {
  const SiteTransmitter* stated = find_transmitter(site_, burst.transmitter);
  if (stated == nullptr ? !site_.targets.track_unlisted
                        : stated->role != TransmitterRole::kDevice) {
    return;
  }
  const DeviceModel device = device_of(stated);
  const auto room = std::find_if(rooms_.begin(), rooms_.end(), [&](const Room& candidate) {
    return candidate.device == device;
  });
  LocationContext context;
  context.target.set_kind(v1::TARGET_KIND_DEVICE);
  context.target.set_mac(to_string(burst.transmitter));
  if (stated != nullptr) {
    context.target.set_name(stated->name);
  }
  context.frame.set_crs("local");
  context.frame.set_site(site_.name);
  context.frame.set_scene_hash(room->room().scene_hash);
  context.frame.set_calibration_id(room->room().calibration_id);
  context.method = options_.method == LocationMethod::kPaper ? "paper" : "rayloc";
  context.valid_for = options_.valid_for;
  out.push_back(location_message(room->locate(burst.frames), context));
}

}  // namespace rayloc
