#include "engine/baselines/places/place_classifier.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/baselines/places/place_weights.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr double kNoPerson =
    0.5;  // a probability: of the empty room, above which no person is seen

}  // namespace

PlaceClassifier::PlaceClassifier(std::shared_ptr<const RoomModel> room,
                                 PlaceClassifierOptions options,
                                 std::shared_ptr<const Training> training,
                                 std::vector<std::size_t> access_points,
                                 Network network)
    : room_(std::move(room)),
      options_(std::move(options)),
      training_(std::move(training)),
      access_points_(std::move(access_points)),
      network_(std::move(network)) {}

Expected<PlaceClassifier> PlaceClassifier::create(std::shared_ptr<const RoomModel> room,
                                                  const PlaceClassifierOptions& options,
                                                  std::shared_ptr<const Training> training) {
  RAYLOC_TRY(check_room(room.get()));
  const auto refuse = [&](const std::string& why) {
    return make_error(ErrorKind::kConfiguration,
                      why + ": run rayloc train SITE --method " + options.method);
  };
  if (training == nullptr || !training->network) {
    return refuse("no training of " + options.method);
  }
  std::vector<std::size_t> access_points;
  for (const AccessPointTraining& learned : training->access_points) {
    const auto found = std::find_if(room->access_points.begin(),
                                    room->access_points.end(),
                                    [&](const auto& ap) { return ap.id == learned.id; });
    if (found == room->access_points.end()) {
      return refuse("trained with " + learned.id + ", which the site does not have");
    }
    access_points.push_back(static_cast<std::size_t>(found - room->access_points.begin()));
  }
  const PlaceNetwork& learned = *training->network;
  const NetworkShape shape{options.kind.network,
                           image_shape(*room, access_points, options.kind),
                           learned.places.size() + (learned.has_empty_room ? 1U : 0U)};
  if (!is_possible(shape) || learned.mean.size() != shape.image.channels ||
      learned.deviation.size() != shape.image.channels) {
    return refuse("trained with other antennas or tones than the site has");
  }
  Network network(shape, options.seed);
  if (!network.set_parameters(learned.parameters)) {
    return refuse("the weights of the training are not those of this network");
  }
  return PlaceClassifier(
      std::move(room), options, std::move(training), std::move(access_points), std::move(network));
}

LocationEstimate PlaceClassifier::locate(std::span<const CsiFrame> frames, std::uint64_t repeat) {
  LocationEstimate estimate;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return estimate;
  }
  const PlaceNetwork& learned = *training_->network;
  BurstImages received = burst_images(*room_,
                                      access_points_,
                                      frames,
                                      options_.kind,
                                      {options_.images, options_.seed + repeat},
                                      estimate);
  if (received.images.empty()) {
    estimate.reason = "no access point used in training received the burst";
    return estimate;
  }
  WeightedPlaces weighted;
  weighted.places = learned.places;
  weighted.weights = mean_probabilities(network_, learned, received.images);
  weighted.temperature = learned.temperature;
  weighted.sigma = learned.sigma;
  weighted.residual = learned.residual;
  if (learned.has_empty_room) {
    const double no_person = weighted.weights.back();
    weighted.weights.pop_back();
    if (no_person > kNoPerson) {
      estimate.reason = "no person detected";
      return estimate;
    }
    for (double& weight : weighted.weights) {
      weight /= 1.0 - no_person;
    }
  }
  summarise_places(*room_, weighted, options_.answer, estimate);
  return estimate;
}

}  // namespace rayloc
