// train_network: Adam [AD] on the cross entropy of labelled images, epoch by epoch.
//
// The state between two epochs is a value: resumed training ends in the same state as an
// uninterrupted run, bit for bit. The order of images is drawn from the seed and the epoch.
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
  double first = 0.9;        // decay of the mean gradient, of the reference
  double second = 0.999;     // of the mean square, of the reference
  double stabiliser = 1e-8;  // of the reference
  std::uint64_t seed = 1;
};

struct TrainingState {
  std::size_t epoch = 0;  // completed epochs
  std::size_t steps = 0;
  std::vector<float> parameters;
  std::vector<float> mean;    // of the gradient; empty: 0
  std::vector<float> square;  // of the gradient
  std::vector<double> loss;   // of each completed epoch, mean over its batches
};

// Continues from `state`, which is new if epoch is 0, up to options.epochs. after_epoch: false ends
// the training there. REQUIRES: at least two images, labels below the classes of the network.
void train_network(Network& network,
                   std::span<const LabelledImage> images,
                   const AdamOptions& options,
                   TrainingState& state,
                   const std::function<bool(const TrainingState&)>& after_epoch);

}  // namespace rayloc
