#include "engine/baselines/network/train_network.h"

#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr std::size_t kSettling = 25;  // batches, a count: the earlier state is weighted 0.9^25

bool has_running_means(NetworkKind kind) { return kind == NetworkKind::kMobileNet; }

// In an order that is the same with every standard library.
std::vector<std::size_t> drawn_order(std::size_t count, std::uint64_t seed, std::size_t epoch) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed),
                         static_cast<std::uint32_t>(seed >> 32U),
                         static_cast<std::uint32_t>(epoch)};
  std::mt19937 random(sequence);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count; i > 1; --i) {
    std::swap(order[i - 1], order[random() % i]);
  }
  return order;
}

// The images of a batch.
struct Batch {
  std::vector<std::span<const float>> images;
  std::vector<std::size_t> labels;
};

// A single remaining image joins the last batch: alone it would have no variance.
std::vector<Batch> batches_of(std::span<const LabelledImage> images,
                              const std::vector<std::size_t>& order,
                              std::size_t size) {
  std::vector<Batch> batches;
  for (std::size_t from = 0; from < order.size();) {
    const std::size_t left = order.size() - from;
    const std::size_t count = left <= size + 1 ? left : size;
    Batch& batch = batches.emplace_back();
    for (std::size_t i = from; i < from + count; ++i) {
      batch.images.emplace_back(images[order[i]].values);
      batch.labels.push_back(images[order[i]].label);
    }
    from += count;
  }
  return batches;
}

void step(const AdamOptions& options, const std::vector<float>& gradient, TrainingState& state) {
  ++state.steps;
  const auto n = static_cast<double>(state.steps);
  const double rate = options.rate * std::sqrt(1.0 - std::pow(options.second, n)) /
                      (1.0 - std::pow(options.first, n));
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const double g = gradient[i];
    const double mean = options.first * double{state.mean[i]} + (1.0 - options.first) * g;
    const double square = options.second * double{state.square[i]} + (1.0 - options.second) * g * g;
    state.mean[i] = static_cast<float>(mean);
    state.square[i] = static_cast<float>(square);
    state.parameters[i] -=
        static_cast<float>(rate * mean / (std::sqrt(square) + options.stabiliser));
  }
}

}  // namespace

void train_network(Network& network,
                   std::span<const LabelledImage> images,
                   const AdamOptions& options,
                   TrainingState& state,
                   const std::function<bool(const TrainingState&)>& after_epoch) {
  RAYLOC_CHECK(images.size() > 1 && options.batch > 1);
  if (state.epoch == 0) {
    state = {};
    state.parameters = network.parameters();
    state.mean.assign(state.parameters.size(), 0.0F);
    state.square.assign(state.parameters.size(), 0.0F);
  }
  while (state.epoch < options.epochs) {
    const auto order = drawn_order(images.size(), options.seed, state.epoch);
    const std::vector<Batch> batches = batches_of(images, order, options.batch);
    double loss = 0.0;
    for (const Batch& batch : batches) {
      RAYLOC_CHECK(network.set_parameters(state.parameters));
      const Network::Slope slope = network.slope(batch.images, batch.labels);
      state.parameters = network.parameters();  // the running means have changed
      step(options, slope.gradient, state);
      loss += slope.loss;
    }
    state.loss.push_back(loss / static_cast<double>(batches.size()));
    ++state.epoch;
    RAYLOC_CHECK(network.set_parameters(state.parameters));
    if (after_epoch && !after_epoch(state)) {
      return;
    }
  }
  RAYLOC_CHECK(network.set_parameters(state.parameters));
  // The running means lag behind the parameters; they settle with the parameters held constant.
  const std::vector<Batch> batches =
      batches_of(images, drawn_order(images.size(), options.seed, options.epochs), options.batch);
  for (std::size_t i = 0; has_running_means(network.shape().kind) && i < kSettling; ++i) {
    const Batch& batch = batches[i % batches.size()];
    network.slope(batch.images, batch.labels);
  }
}

}  // namespace rayloc
