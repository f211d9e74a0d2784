// RoomModel: all properties of a site that do not depend on the target: the scene, the access
// points as calibrated, the carrier and the model of the target device.
//
// A value that is built once (load_room_model() of daemon/site/model, or a test) and then shared,
// const.
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

// Errors of the room model; the terms of the observation model. The defaults are those of a floor
// plan; calibration fits the diffuse power.
struct ModelError {
  double plan_tolerance = 0.015;  // [m], standard deviation of a surface along its normal
  double diffuse = 0.05;          // power of untraced paths at 3 m, relative to the traced power
  double diffuse_exponent = 0.0;  // exponent of its growth with distance
  double diffuse_decay = kDiffuseDecay;  // [s], time constant of its decay after the first ray
  double noise = 2e-3;                   // share of the power that the model does not explain
  double strength = 1.0;  // scales the nominal uncertainty of a ray's power; 0: exact
};

// Power that an access point reports for a transmitter of constant power, minus the traced power
// (traced_power_db()).
struct TransmitterPower {
  MacAddress transmitter;
  double offset_db = 0.0;
  double sigma_db = 0.0;  // standard deviation between positions
};

struct RoomAccessPoint {
  std::string id;
  AntennaArray array;
  std::vector<std::uint8_t> rx_chains;  // receive chain of each element of `array`
  ChainGains gains;                     // empty: not calibrated
  ModelError error;
  // Transmitters of constant power; the received power of others carries no information.
  std::vector<TransmitterPower> powers = {};
  bool are_chains_known = true;  // false: any relative phase of a chain is equally likely
};

// The target device: its antenna and its height.
struct DeviceModel {
  double height = 1.2;        // [m], its mean
  double height_sigma = 0.0;  // [m], standard deviation; 0: the height is known
  AntennaPattern pattern = AntennaPattern::kHalfWaveDipole;
  Polarization polarization = Polarization::kVertical;

  friend bool operator==(const DeviceModel&, const DeviceModel&) = default;
};

inline constexpr int kRayDepth = 2;  // reflections that a floor plan can support

struct RoomModel {
  std::string name;
  std::shared_ptr<const Scene> scene;
  Vec3d bounds_min;  // [m], the room; a fix lies inside
  Vec3d bounds_max;
  OfdmGrid grid;
  std::vector<RoomAccessPoint> access_points;
  DeviceModel device;
  // Exponent of the likelihood: errors of the model are correlated over the burst, so the raw
  // likelihood is overconfident.
  double likelihood_exponent = 0.6;
  // [m], per axis, standard deviation: the error that the survey of the access points and the plan
  // leave in every position, however sharp the likelihood is.
  double sigma_floor = 0.01;
  TraceOptions trace = {.max_depth = kRayDepth};  // of the rays in the likelihood
  // For each surface of the scene, the factor of everything that it reflects, because no slab of
  // one material reproduces its reflection; empty: 1.
  std::vector<std::complex<double>> surface_correction;
  std::string calibration_id;  // hash of the calibration's content, empty without one
  std::string scene_hash;      // hash of the scene's content

  double area() const {  // [m^2], of the bounds
    return (bounds_max.x - bounds_min.x) * (bounds_max.y - bounds_min.y);
  }
};

}  // namespace rayloc
