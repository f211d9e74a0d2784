// PlaceClassifier: which surveyed place a burst comes from, by a network that has seen images of
// bursts from each; and how it learns.
//
// CiFi and DSCP are this with different images and networks. The weights of the places are the mean
// of the network's probabilities over the images of a burst.
//
// Learning has two stages. In the first a fifth of the places is no class: what the network says of
// them tells how sure it may be (weighted_places.h). In the second all places are classes.
//
// Thread safety: for one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/baselines/network/network.h"
#include "engine/baselines/places/channel_images.h"
#include "engine/baselines/places/weighted_places.h"
#include "engine/baselines/training.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlaceClassifierOptions {
  std::string method;  // for messages
  ImageKind kind;
  std::size_t images = 16;  // of a burst, a count
  std::uint64_t seed = 1;
  PlaceAnswer answer;
};

class PlaceClassifier {
 public:
  // An Error without a training, or with one that does not fit the room.
  static Expected<PlaceClassifier> create(std::shared_ptr<const RoomModel> room,
                                          const PlaceClassifierOptions& options,
                                          std::shared_ptr<const Training> training);

  const RoomModel& room() const { return *room_; }
  // frames: of one transmitter, in order of time.
  LocationEstimate locate(std::span<const CsiFrame> frames, std::uint64_t repeat);

 private:
  PlaceClassifier(std::shared_ptr<const RoomModel> room,
                  PlaceClassifierOptions options,
                  std::shared_ptr<const Training> training,
                  std::vector<std::size_t> access_points,
                  Network network);

  std::shared_ptr<const RoomModel> room_;
  PlaceClassifierOptions options_;
  std::shared_ptr<const Training> training_;
  std::vector<std::size_t> access_points_;
  Network network_;
};

struct PlaceTrainingOptions {
  PlaceClassifierOptions classifier;
  std::size_t epochs = 15;
  double cell = 0.0;  // [m], of the areas that places are merged to; 0: each is one
};

// An Error for fewer than ten places, or tones that the network cannot divide.
Expected<std::shared_ptr<const Training>> train_places(const TrainingInput& input,
                                                       const PlaceTrainingOptions& options);

}  // namespace rayloc
