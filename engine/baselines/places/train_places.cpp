#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "engine/baselines/places/place_classifier.h"
#include "engine/baselines/places/place_weights.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr std::size_t kMinSurveyPlaces = 10;  // a count, chosen: fewer are no survey
constexpr std::size_t kHeldOutEvery = 5;      // one in so many classes is held out at first
constexpr double kMinDeviation = 1e-6;        // of a plane's values, chosen: for a constant plane
constexpr std::size_t kStages = 2;            // of learning, a count
// Weight of the empty room in places, a count, chosen: it is not one place among many.
constexpr std::size_t kEmptyRoomCounts = 8;

// Images of a class.
struct Seen {
  Vec3d place;
  std::vector<std::vector<float>> images;  // before standardisation
};

class Trainer {
 public:
  Trainer(const TrainingInput& input, const PlaceTrainingOptions& options)
      : input_(input), options_(options) {}
  Expected<std::shared_ptr<const Training>> run();

 private:
  Expected<void> see();
  std::vector<std::vector<float>> images_of(const std::vector<CsiFrame>& frames,
                                            std::uint64_t number,
                                            std::size_t times = 1);
  void merge_cells();
  void measure_planes();
  Network learn(std::size_t stage, const std::vector<const Seen*>& classes);
  PlaceCertainty first_stage();
  TrainingCheckpoint begin_of(std::size_t stage) const;
  tl::unexpected<Error> stopped() const {
    return make_error(ErrorKind::kUnavailable,
                      options_.classifier.method + ": its training was stopped on request");
  }

  const TrainingInput& input_;
  const PlaceTrainingOptions& options_;
  std::vector<std::size_t> access_points_;
  std::vector<std::size_t> points_;  // points with a burst at each access point
  std::vector<Seen> seen_;
  std::vector<std::vector<float>> empty_room_;  // images of the empty room
  ImageShape shape_;
  PlaceNetwork learned_;
  bool is_stopped_ = false;  // a stop was requested
};

std::vector<std::vector<float>> Trainer::images_of(const std::vector<CsiFrame>& frames,
                                                   std::uint64_t number,
                                                   std::size_t times) {
  LocationEstimate unused;
  BurstImages drawn =
      burst_images(*input_.room,
                   access_points_,
                   frames,
                   options_.classifier.kind,
                   {times * options_.classifier.images, input_.seed * 1'000'003U + number},
                   unused);
  for (std::size_t i = 0; i < drawn.received.size(); ++i) {
    points_[i] += drawn.received[i] ? 1U : 0U;
  }
  return std::move(drawn.images);
}

Expected<void> Trainer::see() {
  const RoomModel& room = *input_.room;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    if (calibration_problem(room, room.access_points[i]).empty()) {
      access_points_.push_back(i);
    }
  }
  points_.resize(access_points_.size());
  shape_ = image_shape(room, access_points_, options_.classifier.kind);
  for (std::size_t i = 0; i < input_.points.size(); ++i) {
    auto images = images_of(input_.points[i].frames, i);
    if (!images.empty()) {
      seen_.push_back({input_.points[i].position, std::move(images)});
    }
  }
  if (!input_.empty.empty()) {
    empty_room_ = images_of(input_.empty, input_.points.size(), kEmptyRoomCounts);
  }
  if (options_.cell > 0.0) {
    merge_cells();
  }
  if (seen_.size() < kMinSurveyPlaces) {
    return bad_input(
        options_.classifier.method + " needs " + std::to_string(kMinSurveyPlaces) +
        " places or more at which an access point received the transmitter; the survey has " +
        std::to_string(seen_.size()));
  }
  if (!is_possible({options_.classifier.kind.network, shape_, seen_.size()})) {
    return make_error(ErrorKind::kConfiguration,
                      options_.classifier.method +
                          " needs two antennas and eight tones or more of an access point");
  }
  measure_planes();
  return {};
}

// Merges the classes of each area; its place is the mean of its points.
void Trainer::merge_cells() {
  std::map<std::pair<long, long>, std::pair<Seen, double>> cells;
  for (Seen& one : seen_) {
    const auto number = [&](double x) { return std::lround(std::floor(x / options_.cell)); };
    auto& [cell, count] = cells[{number(one.place.x), number(one.place.y)}];
    cell.place = (1.0 / (count + 1.0)) * (count * cell.place + one.place);
    count += 1.0;
    std::move(one.images.begin(), one.images.end(), std::back_inserter(cell.images));
  }
  seen_.clear();
  for (auto& [number, cell] : cells) {
    seen_.push_back(std::move(cell.first));
  }
}

void Trainer::measure_planes() {
  learned_.mean.assign(shape_.channels, 0.0);
  learned_.deviation.assign(shape_.channels, 1.0);
  if (!options_.classifier.kind.is_standardised) {
    return;
  }
  const std::size_t plane = shape_.rows * shape_.columns;
  for (std::size_t p = 0; p < shape_.channels; ++p) {
    double count = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (const Seen& one : seen_) {
      for (const auto& image : one.images) {
        for (std::size_t i = p * plane; i < (p + 1) * plane; ++i) {
          const double value{image[i]};
          count += 1.0;
          sum += value;
          squares += value * value;
        }
      }
    }
    learned_.mean[p] = sum / count;
    const double variance = squares / count - learned_.mean[p] * learned_.mean[p];
    learned_.deviation[p] = std::max(kMinDeviation, std::sqrt(std::max(0.0, variance)));
  }
}

TrainingCheckpoint Trainer::begin_of(std::size_t stage) const {
  if (input_.resume && input_.resume->stage == stage) {
    return *input_.resume;
  }
  TrainingCheckpoint begin;
  begin.stage = stage;
  return begin;
}

// Trains on images of these classes, and of the empty room.
Network Trainer::learn(std::size_t stage, const std::vector<const Seen*>& classes) {
  std::vector<LabelledImage> images;
  const auto add = [&](const std::vector<std::vector<float>>& of_class, std::size_t label) {
    for (std::vector<float> image : of_class) {
      standardise(learned_, shape_, image);
      images.push_back({std::move(image), label});
    }
  };
  for (std::size_t i = 0; i < classes.size(); ++i) {
    add(classes[i]->images, i);
  }
  add(empty_room_, classes.size());
  const std::size_t count = classes.size() + (empty_room_.empty() ? 0U : 1U);
  Network network({options_.classifier.kind.network, shape_, count}, input_.seed + stage);
  AdamOptions adam;
  adam.epochs = options_.epochs;
  adam.seed = input_.seed + stage;
  TrainingCheckpoint reached = begin_of(stage);
  reached.temperature = learned_.temperature;
  reached.residual = learned_.residual;
  train_network(network, images, adam, reached.network, [&](const TrainingState& state) {
    if (input_.keep) {
      reached.network = state;
      input_.keep(reached);
    }
    if (input_.progress) {
      const auto done = static_cast<double>(stage * adam.epochs + state.epoch);
      input_.progress({done / static_cast<double>(kStages * adam.epochs),
                       (stage == 0 ? "held out, epoch " : "all, epoch ") +
                           std::to_string(state.epoch) + " of " + std::to_string(adam.epochs) +
                           ", loss " + std::to_string(state.loss.back())});
    }
    is_stopped_ = input_.stop_requested && input_.stop_requested();
    return !is_stopped_;
  });
  if (stage + 1 == kStages) {
    learned_.loss = reached.network.loss;
  }
  return network;
}

PlaceCertainty Trainer::first_stage() {
  std::vector<const Seen*> classes;
  std::vector<const Seen*> others;
  std::mt19937_64 random(input_.seed);
  const std::size_t offset = random() % kHeldOutEvery;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    (i % kHeldOutEvery == offset ? others : classes).push_back(&seen_[i]);
  }
  Network network = learn(0, classes);
  if (is_stopped_) {
    return {};
  }
  WeightedPlaces weighted;
  for (const Seen* one : classes) {
    weighted.places.push_back(one->place);
  }
  weighted.sigma = learned_.sigma;
  std::vector<HeldOutPlace> held;
  for (const Seen* one : others) {
    std::vector<std::vector<float>> images = one->images;
    weighted.weights = mean_probabilities(network, learned_, images);
    weighted.weights.resize(classes.size());  // a person is present
    held.push_back({weighted, one->place});
  }
  return fit_certainty(std::move(held));
}

Expected<std::shared_ptr<const Training>> Trainer::run() {
  RAYLOC_TRY(see());
  std::vector<const Seen*> all;
  for (const Seen& one : seen_) {
    learned_.places.push_back(one.place);
    all.push_back(&one);
  }
  learned_.sigma = surroundings_of(learned_.places);
  learned_.has_empty_room = !empty_room_.empty();
  const PlaceCertainty certainty =
      input_.resume && input_.resume->stage > 0
          ? PlaceCertainty{input_.resume->temperature, input_.resume->residual}
          : first_stage();
  if (is_stopped_) {
    return stopped();
  }
  learned_.temperature = certainty.temperature;
  learned_.residual = certainty.residual;
  Network network = learn(1, all);
  if (is_stopped_) {
    return stopped();
  }
  learned_.parameters = network.parameters();
  auto training = std::make_shared<Training>();
  training->method = options_.classifier.method;
  training->calibration_id = input_.room->calibration_id;
  training->transmitter = input_.transmitter;
  training->values = input_.values;
  for (std::size_t i = 0; i < access_points_.size(); ++i) {
    AccessPointTraining ap;
    ap.id = input_.room->access_points[access_points_[i]].id;
    ap.points = points_[i];
    training->access_points.push_back(std::move(ap));
  }
  training->network = std::move(learned_);
  return training;
}

}  // namespace

Expected<std::shared_ptr<const Training>> train_places(const TrainingInput& input,
                                                       const PlaceTrainingOptions& options) {
  RAYLOC_TRY(check_room(input.room.get()));
  return Trainer(input, options).run();
}

}  // namespace rayloc
