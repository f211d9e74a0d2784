#include "daemon/lab/calibrate/calibrated_site.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <string>

#include "daemon/site/scene/scene_files.h"
#include "engine/base/constants.h"
#include "engine/calibrate/joint/stated_parameter.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

// A change of the pose, with the sigma of that parameter if there is one.
Fitted<double> stated(double change,
                      const ParameterId& id,
                      std::span<const RoomParameter> parameters) {
  const auto found = std::find_if(
      parameters.begin(), parameters.end(), [&](const auto& one) { return one.id == id; });
  return {change, 0.0, found == parameters.end() ? 0.0 : found->sigma};
}

std::string chain_name(const CalibratedAccessPoint& ap, std::size_t rx_chain) {
  return ap.id + ".core" + std::to_string(ap.gains.rx_chains[rx_chain]) + "/core" +
         std::to_string(ap.gains.rx_chains[0]);
}

// Chains that the method fitted together with the room get the sigma that it states.
void state_chains(std::span<const RoomParameter> parameters, CalibratedAccessPoint& ap) {
  for (std::size_t rx_chain = 1; rx_chain < ap.gains.rx_chains.size(); ++rx_chain) {
    const ParameterId phase{chain_name(ap, rx_chain), Quantity::kPhase};
    for (const RoomParameter& parameter : parameters) {
      if (parameter.id == phase && parameter.sigma > 0.0) {
        ap.gain_sigma[rx_chain] = kDegree * parameter.sigma;
        ap.gain_sigma[0] = 0.0;  // reference chain of the others
      }
    }
  }
}

}  // namespace

std::vector<CalibratedAccessPoint> calibrated_access_points(
    const RoomModel& surveyed,
    const RoomCalibration& calibrated,
    std::span<const AccessPointResult> results) {
  std::vector<CalibratedAccessPoint> access_points;
  for (const AccessPointResult& result : results) {
    const RoomAccessPoint& before = surveyed.access_points[result.index];
    const RoomAccessPoint& after = calibrated.room.access_points[result.index];
    const Pose& old_pose = before.array.pose;
    const Pose& new_pose = after.array.pose;
    CalibratedAccessPoint ap;
    ap.id = after.id;
    ap.points = result.fit.samples_used;
    const auto changed = [&](double change, Quantity quantity) {
      return stated(change, {after.id, quantity}, calibrated.parameters);
    };
    ap.position_x = changed(new_pose.position.x - old_pose.position.x, Quantity::kPositionX);
    ap.position_y = changed(new_pose.position.y - old_pose.position.y, Quantity::kPositionY);
    ap.position_z = changed(new_pose.position.z - old_pose.position.z, Quantity::kPositionZ);
    ap.yaw_offset = changed(new_pose.orientation.yaw - old_pose.orientation.yaw, Quantity::kYaw);
    ap.yaw_offset.value += result.fit.yaw_offset.value;
    // If the yaw was held in this stage, the preceding room fit has estimated it.
    ap.yaw_offset.sigma = std::max(ap.yaw_offset.sigma, result.fit.yaw_offset.sigma);
    ap.pitch_offset =
        changed(new_pose.orientation.pitch - old_pose.orientation.pitch, Quantity::kPitch);
    ap.roll_offset =
        changed(new_pose.orientation.roll - old_pose.orientation.roll, Quantity::kRoll);
    ap.plan_tolerance = result.fit.error.plan_tolerance;
    ap.diffuse = result.fit.error.diffuse;
    ap.diffuse_exponent = result.fit.error.diffuse_exponent;
    ap.diffuse_decay = result.fit.error.diffuse_decay;
    ap.noise = result.fit.error.noise;
    ap.gains = result.fit.gains;
    ap.gain_sigma = result.fit.gain_sigma;
    state_chains(calibrated.parameters, ap);
    ap.powers = result.powers;
    for (std::size_t e = 0; e < after.array.element_offset.size(); ++e) {
      ap.element_y.push_back(after.array.element_offset[e].y - before.array.element_offset[e].y);
    }
    access_points.push_back(std::move(ap));
  }
  return access_points;
}

void count_yaw_from_survey(const RoomModel& surveyed,
                           const RoomModel& start,
                           std::vector<RoomParameter>& parameters) {
  for (RoomParameter& parameter : parameters) {
    for (std::size_t a = 0; a < surveyed.access_points.size(); ++a) {
      if (parameter.id == ParameterId{surveyed.access_points[a].id, Quantity::kYaw}) {
        parameter.value += start.access_points[a].array.pose.orientation.yaw -
                           surveyed.access_points[a].array.pose.orientation.yaw;
      }
    }
  }
}

std::vector<RoomParameter> chain_parameters(const CalibratedAccessPoint& ap) {
  constexpr double kDecibels = 20.0 * std::numbers::log10e;  // of one neper
  std::vector<RoomParameter> parameters;
  for (std::size_t rx_chain = 1; rx_chain < ap.gains.rx_chains.size(); ++rx_chain) {
    const std::complex<double> ratio = chain_ratio(ap.gains, rx_chain);
    const std::string name = chain_name(ap, rx_chain);
    const double sigma = std::hypot(ap.gain_sigma[rx_chain], ap.gain_sigma[0]);
    parameters.push_back({{kDecibels * std::log(std::abs(ratio)), 0.0, kDecibels * sigma},
                          {name, Quantity::kGain},
                          "dB"});
    parameters.push_back({{kDegreesPerRadian * std::arg(ratio), 0.0, kDegreesPerRadian * sigma},
                          {name, Quantity::kPhase},
                          "deg"});
  }
  return parameters;
}

std::vector<RoomParameter> model_parameters(const CalibratedAccessPoint& access_point) {
  std::vector<RoomParameter> parameters;
  for (const NamedValue& named : calibrated_values()) {
    const std::string name = named.name;
    if (name.rfind("position", 0) == 0 || name == "pitch_offset" || name == "roll_offset") {
      continue;  // a method that moves the access point states these itself
    }
    parameters.push_back(
        {access_point.*named.value, parse_parameter_id(access_point.id + "." + name), named.unit});
  }
  return parameters;
}

void add_common_parameters(const CalibratedAccessPoint& ap,
                           std::vector<RoomParameter>& parameters) {
  const auto states = [&, stated = parameters.size()](const ParameterId& id) {
    const auto end = parameters.begin() + static_cast<std::ptrdiff_t>(stated);
    return std::find_if(parameters.begin(), end, [&](const auto& one) { return one.id == id; }) !=
           end;
  };
  for (const auto& more : {model_parameters(ap), chain_parameters(ap)}) {
    for (const RoomParameter& parameter : more) {
      const bool yaw = parameter.id.quantity == Quantity::kYawOffset;
      if (!states(yaw ? ParameterId{ap.id, Quantity::kYaw} : parameter.id)) {
        parameters.push_back(parameter);
      }
    }
  }
}

std::vector<CalibratedSurface> calibrated_surfaces(const RoomModel& room) {
  std::vector<CalibratedSurface> surfaces;
  for (std::size_t s = 0; s < room.surface_correction.size(); ++s) {
    if (room.surface_correction[s] != 1.0) {
      surfaces.push_back({s, room.surface_correction[s]});
    }
  }
  return surfaces;
}

std::map<std::string, std::string> refined_scene(const Scene& scene) {
  StatedScene stated;
  for (const RadioMaterial& material : scene.materials()) {
    stated.materials.push_back({material.name,
                                "",
                                material.relative_permittivity,
                                material.conductivity,
                                material.thickness,
                                material.scattering});
  }
  for (const SceneObject& object : scene.objects()) {
    stated.objects.push_back({object.name, scene.materials()[object.material].name, object.mesh});
  }
  return scene_files(stated);
}

}  // namespace rayloc
