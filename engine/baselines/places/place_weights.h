// What a network says of images: probabilities of its classes.
#pragma once

#include <span>
#include <vector>

#include "engine/baselines/network/network.h"
#include "engine/baselines/training.h"

namespace rayloc {

// Takes the mean off each plane and divides by its deviation, in place.
void standardise(const PlaceNetwork& learned, const ImageShape& shape, std::vector<float>& image);

// Of the classes, mean over the images, which are standardised before. REQUIRES: an image.
std::vector<double> mean_probabilities(Network& network,
                                       const PlaceNetwork& learned,
                                       std::span<std::vector<float>> images);

}  // namespace rayloc
