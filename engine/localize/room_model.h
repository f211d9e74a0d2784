// RoomModel: everything about a place that does not depend on the target: the scene, the access
// points as calibrated, the carrier and the device that is looked for.
//
// A value that is built once (load_room_model() of daemon/site, or a test) and then shared, const.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/em/antenna_pattern.h"
#include "engine/observe/chain_gains.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

class Scene;

// What the calibration's held-out points say about how far the model can be trusted.
struct ModelError {
  // Share of the power that the model does not explain: 1 - |correlation|^2, median over held-out
  // points. 1 means that nothing is known.
  double residual = 0.3;
};

struct RoomAccessPoint {
  std::string id;
  AntennaArray array;
  std::vector<std::uint8_t> cores;  // receive chain of each element of `array`
  ChainGains gains;                 // empty: not calibrated
  ModelError error;
};

// The device that is looked for: how it radiates and the height that is assumed.
struct DeviceModel {
  double height = 1.2;  // [m]
  AntennaPattern pattern = AntennaPattern::kHalfWaveDipole;
  Polarization polarization = Polarization::kVertical;

  friend bool operator==(const DeviceModel&, const DeviceModel&) = default;
};

struct RoomModel {
  std::string name;
  std::shared_ptr<const Scene> scene;
  Vec3d bounds_min;  // [m], the room; a fix lies inside
  Vec3d bounds_max;
  OfdmGrid grid;
  std::vector<RoomAccessPoint> access_points;
  DeviceModel device;
  std::string calibration_id;  // hash of the calibration's content, empty without one
  std::string scene_hash;      // hash of the scene's content
};

}  // namespace rayloc
