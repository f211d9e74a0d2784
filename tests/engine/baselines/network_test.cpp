// The networks against numbers of plain numpy and finite differences, and their training.
#include "engine/baselines/network/network.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/baselines/network/train_network.h"

namespace rayloc::network_test {
namespace {

const NetworkShape kSmallLeNet = {NetworkKind::kLeNet, {2, 5, 21}, 3};
const NetworkShape kSmallMobileNet = {NetworkKind::kMobileNet, {2, 5, 21}, 3};

// Parameters and image by the formulas of network_reference.py.
std::vector<double> logits_of_formula(const NetworkShape& shape) {
  Network network(shape, 1);
  std::vector<float> parameters = network.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double sine = std::sin(0.37 * static_cast<double>(i));
    parameters[i] = static_cast<float>(0.02 + 0.1 * sine * sine);
  }
  EXPECT_TRUE(network.set_parameters(parameters));
  std::vector<float> image(shape.image.size());
  for (std::size_t i = 0; i < image.size(); ++i) {
    image[i] = static_cast<float>(std::cos(0.7 * static_cast<double>(i)));
  }
  return network.logits(image);
}

// tests/engine/baselines/network_reference.py printed these.
TEST(Network, ForwardPassIsThatOfPlainNumpy) {
  const auto expect = [](const NetworkShape& shape, const std::vector<double>& reference) {
    const std::vector<double> logits = logits_of_formula(shape);
    ASSERT_EQ(logits.size(), reference.size());
    for (std::size_t i = 0; i < logits.size(); ++i) {
      EXPECT_NEAR(logits[i], reference[i], 1e-5 * std::abs(reference[i])) << i;
    }
  };
  expect(kSmallLeNet, {4352.135231255, 4351.793214343, 4360.068703096});
  expect(kSmallMobileNet, {9.225538158, 9.417142764, 9.512003205});
}

struct Batch {
  std::vector<LabelledImage> images;
  std::vector<std::span<const float>> values;
  std::vector<std::size_t> labels;
};

// Noise, and where `informative` the class as the sign of the first plane.
Batch batch_of(const NetworkShape& shape, std::size_t count, bool informative, unsigned seed = 1) {
  std::mt19937 random(seed);
  const auto noise = [&] {
    return static_cast<float>(static_cast<double>(random()) / 4294967296.0 - 0.5);
  };
  Batch batch;
  for (std::size_t i = 0; i < count; ++i) {
    LabelledImage image;
    image.label = i % shape.classes;
    const float mean = informative ? (image.label == 0 ? -1.0F : 1.0F) : 0.0F;
    for (std::size_t k = 0; k < shape.image.size(); ++k) {
      image.values.push_back((k < shape.image.rows * shape.image.columns ? mean : 0.0F) + noise());
    }
    batch.images.push_back(std::move(image));
  }
  for (const LabelledImage& image : batch.images) {
    batch.values.emplace_back(image.values);
    batch.labels.push_back(image.label);
  }
  return batch;
}

// Gradient of a batch, so that the normalisation by the batch is differentiated too, in single
// precision: every 997th parameter, and the slope along the whole gradient.
void expect_gradient(const NetworkShape& shape) {
  Network network(shape, 7);
  const Batch batch = batch_of(shape, 6, false);
  const std::vector<float> begin = network.parameters();
  const Network::Slope slope = network.slope(batch.values, batch.labels);
  ASSERT_EQ(slope.gradient.size(), begin.size());
  const auto loss_at = [&](const std::vector<float>& parameters) {
    EXPECT_TRUE(network.set_parameters(parameters));
    return network.slope(batch.values, batch.labels).loss;
  };
  double square = 0.0;
  for (const float g : slope.gradient) {
    square += double{g} * double{g};
  }
  ASSERT_GT(square, 0.0);
  constexpr double kStep = 1e-3;
  const auto along = [&](double sign) {
    std::vector<float> moved = begin;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i] += static_cast<float>(sign * kStep * double{slope.gradient[i]} / std::sqrt(square));
    }
    return loss_at(moved);
  };
  EXPECT_NEAR(
      (along(1.0) - along(-1.0)) / (2.0 * kStep), std::sqrt(square), 0.02 * std::sqrt(square));
  std::size_t tried = 0;
  for (std::size_t i = 0; i < begin.size(); i += 997) {
    if (std::abs(double{slope.gradient[i]}) < 0.02) {
      continue;  // below the resolution of single precision
    }
    std::vector<float> moved = begin;
    moved[i] += 5e-3F;
    const double above = loss_at(moved);
    moved[i] -= 1e-2F;
    const double stated{slope.gradient[i]};
    EXPECT_NEAR((above - loss_at(moved)) / 1e-2, stated, 0.1 * std::abs(stated)) << i;
    ++tried;
  }
  EXPECT_GT(tried, 0U);
}

TEST(Network, GradientOfLeNetIsThatOfFiniteDifferences) { expect_gradient(kSmallLeNet); }

TEST(Network, GradientOfMobileNetIsThatOfFiniteDifferences) { expect_gradient(kSmallMobileNet); }

std::vector<float> trained(const NetworkShape& shape,
                           const Batch& batch,
                           std::size_t epochs,
                           double* loss = nullptr) {
  Network network(shape, 3);
  AdamOptions adam;
  adam.epochs = epochs;
  adam.batch = 16;
  TrainingState state;
  train_network(network, batch.images, adam, state, {});
  if (loss != nullptr) {
    *loss = state.loss.back();
  }
  return network.parameters();
}

TEST(TrainNetwork, FitsThirtyTwoImagesExactly) {
  for (const NetworkShape& shape : {kSmallLeNet, kSmallMobileNet}) {
    double loss = 1.0;
    trained(shape, batch_of(shape, 32, false), shape.kind == NetworkKind::kLeNet ? 80 : 60, &loss);
    EXPECT_LT(loss, 0.01);
  }
}

TEST(TrainNetwork, ClassifiesUnseenImages) {
  for (NetworkShape shape : {kSmallLeNet, kSmallMobileNet}) {
    shape.classes = 2;
    Network network(shape, 3);
    ASSERT_TRUE(network.set_parameters(trained(shape, batch_of(shape, 64, true), 10)));
    for (const LabelledImage& image : batch_of(shape, 40, true, 2).images) {
      const auto logits = network.logits(image.values);
      EXPECT_EQ(logits[1] > logits[0], image.label == 1);
    }
  }
}

TEST(TrainNetwork, IsTheSameTwiceAndAfterAnInterruption) {
  for (const NetworkShape& shape : {kSmallLeNet, kSmallMobileNet}) {
    const Batch batch = batch_of(shape, 33, false);  // one image is left over
    const std::vector<float> whole = trained(shape, batch, 4);
    EXPECT_EQ(whole, trained(shape, batch, 4));
    AdamOptions adam;
    adam.epochs = 4;
    adam.batch = 16;
    TrainingState state;
    Network first(shape, 3);
    train_network(
        first, batch.images, adam, state, [](const TrainingState& s) { return s.epoch < 2; });
    EXPECT_EQ(state.epoch, 2U);
    Network second(shape, 99);
    train_network(second, batch.images, adam, state, {});
    EXPECT_EQ(second.parameters(), whole);
  }
}

TEST(Network, RefusesOtherParameters) {
  Network network(kSmallLeNet, 1);
  std::vector<float> parameters = network.parameters();
  parameters[3] = std::nanf("");
  EXPECT_FALSE(network.set_parameters(parameters));
  parameters.pop_back();
  EXPECT_FALSE(network.set_parameters(parameters));
  EXPECT_FALSE(is_possible({NetworkKind::kLeNet, {2, 4, 21}, 3}));
  EXPECT_FALSE(is_possible({NetworkKind::kLeNet, {2, 5, 7}, 3}));
  EXPECT_FALSE(is_possible({NetworkKind::kMobileNet, {0, 5, 21}, 3}));
  EXPECT_FALSE(is_possible({NetworkKind::kMobileNet, {2, 5, 21}, 1}));
}

// A batch has other means than its images: what one image is taken for must not depend on others.
TEST(Network, OneImageDoesNotDependOnOthers) {
  Network network(kSmallMobileNet, 1);
  const Batch batch = batch_of(kSmallMobileNet, 4, false);
  const auto alone = network.logits(batch.values[0]);
  network.logits(batch.values[1]);
  EXPECT_EQ(network.logits(batch.values[0]), alone);
}

}  // namespace
}  // namespace rayloc::network_test
