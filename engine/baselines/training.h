// Training: the parameters that a method learned at a site from the calibration survey (`rayloc
// train`); a plain value. daemon/site/model/training_file stores it.
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
#include "engine/baselines/paths/path_loss_law.h"
#include "engine/baselines/settings.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct AccessPointTraining {
  std::string id;
  std::size_t points = 0;  // number of surveyed points used
  // [rad], standard deviation of a direct path's phase between antennas; 0: not learned
  double sigma_psi = 0.0;
  double outliers = 0.0;                 // share of bursts with a wrong direct path
  std::optional<PathLossLaw> path_loss;  // of the transmitters of constant power
};

// A network that classifies places by their images.
struct PlaceNetwork {
  std::vector<Vec3d> places;    // one per class
  bool has_empty_room = false;  // an additional class: the empty room
  std::vector<double> mean;     // of each plane of an image, and its standard deviation
  std::vector<double> deviation;
  double temperature = 1.0;       // of the weights (weighted_places.h)
  double sigma = 0.0;             // [m]
  double residual = 0.0;          // a probability
  std::vector<float> parameters;  // of the network
  std::vector<double> loss;       // of each epoch
};

struct Training {
  std::string method;
  std::string calibration_id;              // of the room at training
  std::vector<MacAddress> constant_power;  // transmitters to which the path-loss laws apply
  std::vector<AccessPointTraining> access_points;
  std::optional<MacAddress> transmitter;  // sender of the frames, for people
  BaselineValues values;                  // settings of the method at training
  std::optional<PlaceNetwork> network;

  const AccessPointTraining* find(const std::string& id) const;
};

// A surveyed point and the frames that all access points received from it.
struct TrainingPoint {
  Vec3d position;
  std::vector<CsiFrame> frames;
};

// State of a training of two stages between two epochs: first with a part of the points, of which
// the others calibrate the network's confidence, then with all.
struct TrainingCheckpoint {
  std::size_t stage = 0;
  double temperature = 1.0;  // from the first stage
  double residual = 0.0;
  TrainingState network;
};

struct TrainingProgress {
  double share = 0.0;  // completed share of the work
  std::string what;    // "epoch 3 of 15, loss 1.24"; may be empty
};

struct TrainingInput {
  std::shared_ptr<const RoomModel> room;
  std::vector<TrainingPoint> points;
  std::vector<CsiFrame> empty;             // for people: frames of the empty room; optional
  std::optional<MacAddress> transmitter;   // sender of the frames, for people
  std::vector<MacAddress> constant_power;  // as stated in the site
  BaselineValues values;
  std::uint64_t seed = 1;
  std::optional<TrainingCheckpoint> resume;
  // All may be empty. keep: called after each epoch of a network. stop_requested: polled after it;
  // true ends the training with an Error (kUnavailable).
  std::function<void(const TrainingProgress&)> progress;
  std::function<void(const TrainingCheckpoint&)> keep;
  std::function<bool()> stop_requested;
};

}  // namespace rayloc
