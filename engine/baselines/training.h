// Training: what a method has learned of a site from the survey that calibration uses as well
// (`rayloc train`); a plain value. daemon/site/training_file keeps it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/baselines/paths/level_law.h"
#include "engine/baselines/settings.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct AccessPointTraining {
  std::string id;
  std::size_t points = 0;  // surveyed points that it rests on
  double sigma_psi = 0.0;  // [rad], standard deviation of a direct path's phase between antennas
  double outliers = 0.0;   // share of the bursts whose direct path is another
  std::optional<LevelLaw> level;  // of the transmitters of constant power
};

struct Training {
  std::string method;
  std::string calibration_id;              // of the room that it was learned in
  std::vector<MacAddress> constant_power;  // transmitters that the laws of level hold for
  std::vector<AccessPointTraining> access_points;

  const AccessPointTraining* find(const std::string& id) const;
};

// A surveyed point and what was heard there, of all access points.
struct TrainingPoint {
  Vec3d position;
  std::vector<CsiFrame> frames;
};

struct TrainingInput {
  std::shared_ptr<const RoomModel> room;
  std::vector<TrainingPoint> points;
  std::vector<MacAddress> constant_power;  // as the site states it
  BaselineValues values;
  std::uint64_t seed = 1;
  // The share of the work that is done; may be empty.
  std::function<void(double)> progress;
};

}  // namespace rayloc
