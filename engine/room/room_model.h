// RoomModel: everything about a place that does not depend on the target: the scene, the access
// points as calibrated, the carrier and the device that is looked for.
//
// A value that is built once (load_room_model() of daemon/site, or a test) and then shared, const.
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/mac_address.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/em/antenna_pattern.h"
#include "engine/observe/chain_gains.h"
#include "engine/scene/antenna_array.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

class Scene;

inline constexpr double kDiffuseDecay = 18e-9;  // [s], of a furnished room

// How far the room may differ from its model; the terms of the observation model. The defaults are
// those of a floor plan; calibration fits the diffuse power.
struct ModelError {
  double plan_tolerance = 0.015;  // [m], standard deviation of a surface along its normal
  double diffuse = 0.05;          // power of what is not traced at 3 m, share of the traced power
  double diffuse_exponent = 0.0;  // it grows with distance to this power
  double diffuse_decay = kDiffuseDecay;  // [s] after the first ray: time in which it falls to 1/e
  double noise = 2e-3;                   // share of the power that no part of the model explains
  double strength = 1.0;  // of the usual uncertainty of a ray's power; 0: known exactly
};

// What an access point states as the level of a transmitter of constant power, less the power that
// is traced (traced_level_db()).
struct TransmitterLevel {
  MacAddress transmitter;
  double offset_db = 0.0;
  double sigma_db = 0.0;  // standard deviation, from place to place
};

struct RoomAccessPoint {
  std::string id;
  AntennaArray array;
  std::vector<std::uint8_t> cores;  // receive chain of each element of `array`
  ChainGains gains;                 // empty: not calibrated
  ModelError error;
  // Of the transmitters whose power is known to be constant; of others the level says nothing.
  std::vector<TransmitterLevel> levels = {};
  bool are_chains_known = true;  // false: any phase of one chain against another is as likely
};

// The device that is looked for: how it radiates and how high it is.
struct DeviceModel {
  double height = 1.2;        // [m], its mean
  double height_sigma = 0.0;  // [m], standard deviation; 0: the height is known
  AntennaPattern pattern = AntennaPattern::kHalfWaveDipole;
  Polarization polarization = Polarization::kVertical;

  friend bool operator==(const DeviceModel&, const DeviceModel&) = default;
};

inline constexpr int kRayDepth = 2;  // reflections of the rays that a floor plan is worth

struct RoomModel {
  std::string name;
  std::shared_ptr<const Scene> scene;
  Vec3d bounds_min;  // [m], the room; a fix lies inside
  Vec3d bounds_max;
  OfdmGrid grid;
  std::vector<RoomAccessPoint> access_points;
  DeviceModel device;
  // Exponent of the likelihood: what is wrong with the model is wrong in the same way all over the
  // burst, so the raw likelihood is too sure of itself.
  double likelihood_exponent = 0.6;
  // [m], each axis, standard deviation: what the survey of the access points and the plan leave in
  // every position, however sharp the likelihood is.
  double least_sigma = 0.01;
  TraceOptions trace = {.max_depth = kRayDepth};  // of the rays that the likelihood knows
  // Of each surface of the scene: what everything that it reflects is multiplied by, because no
  // slab of one material behaves like it; empty: 1.
  std::vector<std::complex<double>> surface_correction;
  std::string calibration_id;  // hash of the calibration's content, empty without one
  std::string scene_hash;      // hash of the scene's content

  double area() const {  // [m^2], of the bounds
    return (bounds_max.x - bounds_min.x) * (bounds_max.y - bounds_min.y);
  }
};

}  // namespace rayloc
