// train_network: Adam [AD] on the cross entropy of labelled images, epoch by epoch.
//
// The state between two epochs is a value: who keeps it can go on later and ends where the
// uninterrupted run ends, bit for bit. The order of the images is drawn by the seed and the epoch.
//
// References: [AD] D. Kingma, J. Ba, ICLR 2015.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/baselines/network/network.h"

namespace rayloc {

struct LabelledImage {
  std::vector<float> values;
  std::size_t label = 0;
};

struct AdamOptions {
  std::size_t epochs = 15;
  std::size_t batch = 64;    // images, a count
  double rate = 1e-3;        // of a step
  double first = 0.9;        // forgetting of the mean gradient, of the reference
  double second = 0.999;     // of the mean square, of the reference
  double stabiliser = 1e-8;  // of the reference
  std::uint64_t seed = 1;
};

struct TrainingState {
  std::size_t epoch = 0;  // that were done
  std::size_t steps = 0;
  std::vector<float> parameters;
  std::vector<float> mean;    // of the gradient; empty: 0
  std::vector<float> square;  // of the gradient
  std::vector<double> loss;   // of each epoch done, mean over its batches
};

// Goes on from `state`, which is new where epoch is 0, to options.epochs. after_epoch: false ends
// the training there. REQUIRES: two images or more, labels below the classes of the network.
void train_network(Network& network,
                   std::span<const LabelledImage> images,
                   const AdamOptions& options,
                   TrainingState& state,
                   const std::function<bool(const TrainingState&)>& after_epoch);

}  // namespace rayloc
