#include "daemon/pipeline/device_estimator.h"

#include <algorithm>
#include <utility>

#include "daemon/publish/location_message.h"
#include "daemon/site/room_model.h"

namespace rayloc {

const RoomModel& DeviceEstimator::Room::room() const {
  return std::visit([](const auto& of) -> const RoomModel& { return of->room(); }, localizer);
}

LocationEstimate DeviceEstimator::Room::locate(std::span<const CsiFrame> frames) const {
  return std::visit([&](const auto& of) { return of->locate(frames); }, localizer);
}

Expected<DeviceEstimator::Room> DeviceEstimator::prepare(
    std::shared_ptr<const RoomModel> room) const {
  const DeviceModel device = room->device;
  if (options_.method == LocationMethod::kPaper) {
    auto made = PaperLocalizer::create(std::move(room), options_.paper);
    if (!made) {
      return tl::make_unexpected(made.error());
    }
    return Room{device, std::make_shared<const PaperLocalizer>(*std::move(made)), std::nullopt};
  }
  auto made = Localizer::create(std::move(room), options_.localizer);
  if (!made) {
    return tl::make_unexpected(made.error());
  }
  const auto localizer = std::make_shared<const Localizer>(*std::move(made));
  return Room{device, localizer, DeviceTracker(localizer, options_.tracker)};
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
  estimator->monitor_ =
      std::make_unique<CalibrationMonitor>(std::make_shared<const RoomModel>(*room));
  return estimator;
}

void DeviceEstimator::check_calibration(const SiteTransmitter& fixed, const Burst& burst) {
  if (!fixed.position) {
    return;
  }
  const DeviceModel device{fixed.position->z, fixed.pattern, fixed.polarization};
  monitor_->observe({*fixed.position, device}, burst.frames);
  const std::lock_guard lock(mutex_);
  warnings_ = monitor_->warnings();
}

std::vector<CalibrationWarning> DeviceEstimator::calibration_warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

void DeviceEstimator::estimate(const Burst& burst, std::vector<v1::Location>& out) {
  const SiteTransmitter* stated = find_transmitter(site_, burst.transmitter);
  if (stated != nullptr && stated->role == TransmitterRole::kFixed) {
    check_calibration(*stated, burst);
    return;
  }
  if (stated == nullptr ? !site_.targets.track_unlisted
                        : stated->role != TransmitterRole::kDevice) {
    return;
  }
  const DeviceModel device = device_of(stated);
  const auto room = std::find_if(rooms_.begin(), rooms_.end(), [&](const Room& candidate) {
    return candidate.device == device;
  });
  const std::size_t first = out.size();
  out.push_back(location_message(room->locate(burst.frames), context_of(burst.transmitter, *room)));
  if (room->tracker) {
    std::vector<DeviceUpdate> updates;
    room->tracker->hear(burst.transmitter, burst.frames, updates);
    append(updates, *room, out);
  }
  for (const CalibrationWarning& warning : calibration_warnings()) {
    for (std::size_t i = first; i < out.size(); ++i) {
      out[i].mutable_quality()->add_warnings(warning.text);
    }
  }
}

void DeviceEstimator::advance(Timestamp time, std::vector<v1::Location>& out) {
  for (Room& room : rooms_) {
    if (room.tracker) {
      std::vector<DeviceUpdate> updates;
      room.tracker->advance(time, updates);
      append(updates, room, out);
    }
  }
}

LocationContext DeviceEstimator::context_of(const MacAddress& device, const Room& room) const {
  const RoomModel& model = room.room();
  LocationContext context;
  context.target.set_kind(v1::TARGET_KIND_DEVICE);
  context.target.set_mac(to_string(device));
  if (const SiteTransmitter* stated = find_transmitter(site_, device)) {
    context.target.set_name(stated->name);
  }
  context.frame.set_crs("local");
  context.frame.set_site(site_.name);
  context.frame.set_scene_hash(model.scene_hash);
  context.frame.set_calibration_id(model.calibration_id);
  context.method = options_.method == LocationMethod::kPaper ? "paper" : "rayloc";
  context.valid_for = options_.valid_for;
  return context;
}

void DeviceEstimator::append(const std::vector<DeviceUpdate>& updates,
                             const Room& room,
                             std::vector<v1::Location>& out) const {
  for (const DeviceUpdate& update : updates) {
    out.push_back(filtered_message(update.estimate, context_of(update.device, room)));
  }
}

}  // namespace rayloc
