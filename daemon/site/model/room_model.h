// load_room_model: the engine's RoomModel of a validated Site: reads the scene with the site's
// material overrides, and the calibration file if the site names one. A scene that is not the room
// that the site states is an error (room_match.h, which has warnings as well).
#pragma once

#include <memory>
#include <string>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"
#include "engine/scene/read/load_scene.h"

namespace rayloc {

// The device model is that of the site's first transmitter with role "device", otherwise the
// default height with a vertical half-wave dipole; change `RoomModel::device` for another one.
Expected<RoomModel> load_room_model(const Site& site);
// The same with a scene in memory, either from the site's file or one that will replace it.
Expected<RoomModel> room_model_of(const Site& site, std::shared_ptr<const Scene> scene);

// The room on another channel, `centre_hz` its centre: materials are evaluated there. All other
// data, including the calibration on the site's channel, is unchanged from the site's `room`.
Expected<RoomModel> room_on_channel(const Site& site, const RoomModel& room, double centre_hz);

// Model of a transmitter of the site; the height of a fixed one is that of its position, exactly.
DeviceModel device_model(const SiteTransmitter& transmitter);
// Model of a device that the site does not list.
DeviceModel unlisted_device(const Site& site);

// The site's carrier and materials, for load_scene().
SceneOptions scene_options(const Site& site);

}  // namespace rayloc
