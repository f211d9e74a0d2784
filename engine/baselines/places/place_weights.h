// Output of a network for images: probabilities of its classes.
#pragma once

#include <span>
#include <vector>

#include "engine/baselines/network/network.h"
#include "engine/baselines/training.h"

namespace rayloc {

// Subtracts the mean of each plane and divides by its deviation, in place.
void standardise(const PlaceNetwork& learned, const ImageShape& shape, std::vector<float>& image);

// Class probabilities, mean over the images, which are standardised first. REQUIRES: an image.
std::vector<double> mean_probabilities(Network& network,
                                       const PlaceNetwork& learned,
                                       std::span<std::vector<float>> images);

}  // namespace rayloc
