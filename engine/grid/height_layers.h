// HeightLayers: the possible heights of a target, as layers about the mean one.
//
// A height is an unknown with a normal prior. The layers cover the probable
// heights inside the room; nothing is stored for each layer of each cell of a room.
#pragma once

#include <cstddef>
#include <vector>

namespace rayloc {

struct HeightPrior {
  double mean = 0.0;   // [m]
  double sigma = 0.0;  // [m], standard deviation; 0: the height is known
};

// By default one layer: the height is known.
struct HeightLayers {
  std::vector<double> offset{0.0};  // [m], middle of each layer relative to HeightPrior::mean
  std::vector<double> weight{1.0};  // prior probability of each layer, sum 1
  double thickness = 0.0;           // [m]; 0: the height is known, one layer

  std::size_t size() const { return offset.size(); }
  bool is_known() const { return thickness <= 0.0; }
};

// The layers in a room whose floor and ceiling are at these heights [m].
HeightLayers height_layers(const HeightPrior& prior, double floor, double ceiling);

// Probability of each layer for a normally distributed height: mean [m], relative to
// HeightPrior::mean, and standard deviation [m]. REQUIRES: sigma > 0.
std::vector<double> layer_probabilities(const HeightLayers& layers, double mean, double sigma);

// Heights within a layer that are evaluated one by one: offsets from HeightPrior::mean [m] and
// shares of the layer's probability, sum 1. They are at most `most` [m] apart.
struct HeightSlice {
  double offset = 0.0;
  double weight = 1.0;
};
std::vector<HeightSlice> slices_of(const HeightLayers& layers,
                                   std::size_t layer,
                                   double sigma,
                                   double most);

}  // namespace rayloc
