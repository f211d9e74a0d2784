#include "engine/baselines/places/place_weights.h"

#include <algorithm>
#include <cmath>

namespace rayloc {

void standardise(const PlaceNetwork& learned, const ImageShape& shape, std::vector<float>& image) {
  const std::size_t plane = shape.rows * shape.columns;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const std::size_t p = i / plane;
    image[i] = static_cast<float>((double{image[i]} - learned.mean[p]) / learned.deviation[p]);
  }
}

std::vector<double> mean_probabilities(Network& network,
                                       const PlaceNetwork& learned,
                                       std::span<std::vector<float>> images) {
  std::vector<double> mean(network.shape().classes);
  for (std::vector<float>& image : images) {
    standardise(learned, network.shape().image, image);
    std::vector<double> logits = network.logits(image);
    const double most = *std::max_element(logits.begin(), logits.end());
    double sum = 0.0;
    for (double& logit : logits) {
      logit = std::exp(logit - most);
      sum += logit;
    }
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += logits[i] / (sum * static_cast<double>(images.size()));
    }
  }
  return mean;
}

}  // namespace rayloc
