#include "daemon/site/model/room_model.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/room_match.h"
#include "engine/scene/scene_hash.h"

namespace rayloc {
namespace {

DeviceModel device_of(const Site& site) {
  for (const SiteTransmitter& transmitter : site.transmitters) {
    if (transmitter.role == TransmitterRole::kDevice) {
      return device_model(transmitter);
    }
  }
  return unlisted_device(site);
}

// Power offsets of the transmitters that the site still states to have constant power.
std::vector<TransmitterPower> constant_powers(std::vector<TransmitterPower> powers,
                                              const Site& site) {
  std::erase_if(powers, [&](const TransmitterPower& power) {
    const SiteTransmitter* stated = find_transmitter(site, power.transmitter);
    return stated == nullptr || !stated->constant_power;
  });
  return powers;
}

// [rad], chosen: a phase with this uncertainty is unknown; that of a uniform phase is 1.8.
constexpr double kUnknown = 1.5;

// Adds the calibration results of an access point to the surveyed values.
void apply_to(RoomAccessPoint& ap, CalibratedAccessPoint&& found, const Site& site) {
  Pose& pose = ap.array.pose;
  pose.position =
      pose.position + Vec3d{found.position_x.value, found.position_y.value, found.position_z.value};
  pose.orientation.yaw += found.yaw_offset.value;
  pose.orientation.pitch += found.pitch_offset.value;
  pose.orientation.roll += found.roll_offset.value;
  for (std::size_t e = 0; e < ap.array.element_offset.size(); ++e) {
    ap.array.element_offset[e].y += found.element_y.at(e);
  }
  ap.error = {found.plan_tolerance.value,
              found.diffuse.value,
              found.diffuse_exponent.value,
              found.diffuse_decay.value,
              found.noise.value};
  const auto& sigma = found.gain_sigma;
  ap.are_chains_known = sigma.empty() || *std::max_element(sigma.begin(), sigma.end()) < kUnknown;
  ap.gains = std::move(found.gains);
  ap.powers = constant_powers(std::move(found.powers), site);
}

Expected<void> apply_calibration(const Site& site, RoomModel& room) {
  const std::filesystem::path& file = *site.calibration_file;
  auto calibration = load_calibration_file(file);
  RAYLOC_TRY(calibration);
  if (calibration->scene_hash != room.scene_hash) {
    return make_error(ErrorKind::kConfiguration,
                      file.string() + ": made for another scene (" + calibration->scene_hash +
                          ", this one is " + room.scene_hash +
                          "); calibrate again, or restore the scene");
  }
  room.calibration_id = calibration->id;
  room.likelihood_exponent = calibration->likelihood_exponent.value;
  room.sigma_floor = calibration->sigma_floor.value;
  room.trace.max_depth = calibration->ray_depth;
  room.trace.transmission = calibration->transmission;
  if (!calibration->surfaces.empty()) {
    room.surface_correction.assign(room.scene->surfaces().size(), 1.0);
  }
  for (const CalibratedSurface& surface : calibration->surfaces) {
    if (surface.index >= room.surface_correction.size()) {
      return make_error(ErrorKind::kConfiguration,
                        file.string() + ": surface " + std::to_string(surface.index) +
                            " does not exist in the scene; calibrate again");
    }
    room.surface_correction[surface.index] = surface.correction;
  }
  for (CalibratedAccessPoint& found : calibration->access_points) {
    const auto ap = std::find_if(room.access_points.begin(),
                                 room.access_points.end(),
                                 [&](const RoomAccessPoint& one) { return one.id == found.id; });
    if (ap == room.access_points.end()) {
      return make_error(
          ErrorKind::kConfiguration,
          file.string() + ": the site has no access point '" + found.id + "'; calibrate again");
    }
    if (found.gains.rx_chains != ap->rx_chains || found.gains.grid != room.grid) {
      return make_error(ErrorKind::kConfiguration,
                        file.string() + ": access point '" + found.id +
                            "' was calibrated with other cores or tones than site.toml states; "
                            "calibrate again");
    }
    apply_to(*ap, std::move(found), site);
  }
  return {};
}

}  // namespace

DeviceModel device_model(const SiteTransmitter& transmitter) {
  DeviceModel device;
  device.height = transmitter.height;
  device.height_sigma = transmitter.height_sigma;
  if (transmitter.role == TransmitterRole::kFixed && transmitter.position) {
    device.height = transmitter.position->z;
    device.height_sigma = 0.0;
  }
  device.pattern = transmitter.pattern;
  device.polarization = transmitter.polarization;
  return device;
}

DeviceModel unlisted_device(const Site& site) {
  DeviceModel device;
  device.height = site.targets.height;
  device.height_sigma = site.targets.height_sigma;
  return device;
}

SceneOptions scene_options(const Site& site) {
  SceneOptions options;
  options.carrier_hz = site.carrier.grid.centre_hz;
  for (const auto& [name, material] : site.materials) {
    options.materials[name] = {material.relative_permittivity,
                               material.conductivity,
                               material.thickness,
                               material.scattering_coefficient,
                               material.xpd_coefficient};
  }
  return options;
}

Expected<RoomModel> load_room_model(const Site& site) {
  auto scene = load_scene(site.scene_file, scene_options(site));
  RAYLOC_TRY(scene);
  return room_model_of(site, std::make_shared<const Scene>(*std::move(scene)));
}

Expected<RoomModel> room_on_channel(const Site& site, const RoomModel& room, double centre_hz) {
  SceneOptions options = scene_options(site);
  options.carrier_hz = centre_hz;
  auto scene = load_scene(site.scene_file, options);
  RAYLOC_TRY(scene);
  RoomModel other = room;
  other.scene = std::make_shared<const Scene>(*std::move(scene));
  other.grid.centre_hz = centre_hz;
  return other;
}

Expected<RoomModel> room_model_of(const Site& site, std::shared_ptr<const Scene> scene) {
  RAYLOC_TRY(check_room(*scene, site));
  RoomModel room;
  room.name = site.name;
  room.scene = std::move(scene);
  room.scene_hash = scene_hash(*room.scene);
  room.bounds_min = site.has_bounds ? site.bounds_min : room.scene->bounds_min();
  room.bounds_max = site.has_bounds ? site.bounds_max : room.scene->bounds_max();
  room.grid = site.carrier.grid;
  room.device = device_of(site);
  for (const SiteAccessPoint& ap : site.access_points) {
    room.access_points.push_back({ap.id, ap.array, ap.rx_chains, {}, {}});
  }
  if (site.calibration_file) {
    RAYLOC_TRY(apply_calibration(site, room));
  }
  return room;
}

}  // namespace rayloc
