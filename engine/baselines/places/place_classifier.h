// PlaceClassifier: selects the surveyed place of a burst with a network trained on images of bursts
// from each place; and its training.
//
// CiFi and DSCP are this classifier with different images and networks. The weights of the places
// are the mean of the network's probabilities over the images of a burst.
//
// Training has two stages. In the first a fifth of the places is not a class: the network's output
// for them calibrates its confidence (weighted_places.h). In the second all places are classes.
//
// Thread safety: use from one thread only.
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
  std::size_t images = 16;  // images of a burst, a count
  std::uint64_t seed = 1;
  PlaceAnswer answer;
};

class PlaceClassifier {
 public:
  // An Error without a training, or with one that does not match the room.
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
  double cell = 0.0;  // [m], of the areas that places are merged to; 0: no merging
};

// An Error for fewer than ten places, or a number of tones that the network cannot divide.
Expected<std::shared_ptr<const Training>> train_places(const TrainingInput& input,
                                                       const PlaceTrainingOptions& options);

}  // namespace rayloc
