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
#include "engine/baselines/network/train_network.h"
#include "engine/baselines/paths/level_law.h"
#include "engine/baselines/settings.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct AccessPointTraining {
  std::string id;
  std::size_t points = 0;  // surveyed points that it rests on
  // [rad], standard deviation of a direct path's phase between antennas; 0: not what was learned
  double sigma_psi = 0.0;
  double outliers = 0.0;          // share of the bursts whose direct path is another
  std::optional<LevelLaw> level;  // of the transmitters of constant power
};

// A network that knows places by their images.
struct PlaceNetwork {
  std::vector<Vec3d> places;  // one a class
  bool knows_nobody = false;  // one class more: the empty room
  std::vector<double> mean;   // of each plane of an image, and its standard deviation
  std::vector<double> deviation;
  double temperature = 1.0;       // of the weights (weighted_places.h)
  double sigma = 0.0;             // [m]
  double residual = 0.0;          // a probability
  std::vector<float> parameters;  // of the network
  std::vector<double> loss;       // of each epoch
};

struct Training {
  std::string method;
  std::string calibration_id;              // of the room that it was learned in
  std::vector<MacAddress> constant_power;  // transmitters that the laws of level hold for
  std::vector<AccessPointTraining> access_points;
  std::optional<MacAddress> transmitter;  // of people, who sent
  BaselineValues values;                  // what the method was told
  std::optional<PlaceNetwork> network;

  const AccessPointTraining* find(const std::string& id) const;
};

// A surveyed point and what was heard there, of all access points.
struct TrainingPoint {
  Vec3d position;
  std::vector<CsiFrame> frames;
};

// Where a training of two stages stands between two epochs: first with a part of the points, of
// which the others tell how sure the network may be, then with all.
struct TrainingCheckpoint {
  std::size_t stage = 0;
  double temperature = 1.0;  // from the first stage
  double residual = 0.0;
  TrainingState network;
};

struct TrainingProgress {
  double share = 0.0;  // of the work that is done
  std::string what;    // "epoch 3 of 15, loss 1.24"; may be empty
};

struct TrainingInput {
  std::shared_ptr<const RoomModel> room;
  std::vector<TrainingPoint> points;
  std::vector<CsiFrame> empty;             // of people: while nobody was there; may be none
  std::optional<MacAddress> transmitter;   // of people, who sent
  std::vector<MacAddress> constant_power;  // as the site states it
  BaselineValues values;
  std::uint64_t seed = 1;
  std::optional<TrainingCheckpoint> resume;
  // Both may be empty. keep: after each epoch of a network.
  std::function<void(const TrainingProgress&)> progress;
  std::function<void(const TrainingCheckpoint&)> keep;
};

}  // namespace rayloc
