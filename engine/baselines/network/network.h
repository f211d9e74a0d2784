// Network: the two image classifiers of the trained methods, by dlib.
//
// CiFi's has the shape of LeNet: three convolutions with pooling between them and two full layers.
// DSCP's has that of MobileNet: a convolution and four blocks of a depthwise and a pointwise
// convolution, each with batch normalisation, and a mean over the image. The papers' tables of
// layers were not readable; the sizes are ours.
//
// Only this folder includes dlib. Images are [channel][row][column], columns fastest.
//
// References: [CF] X. Wang et al., CiFi, IEEE ICC 2017; [DS] DSCP, WCMC 2021; dlib 19.24.
// Thread safety: use from one thread only; several objects may be used at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace rayloc {

enum class NetworkKind { kLeNet, kMobileNet };

struct ImageShape {
  std::size_t channels = 0;
  std::size_t rows = 0;
  std::size_t columns = 0;

  std::size_t size() const { return channels * rows * columns; }
};

struct NetworkShape {
  NetworkKind kind = NetworkKind::kLeNet;
  ImageShape image;
  std::size_t classes = 0;
};

// True if the layers can divide these rows and columns.
bool is_possible(const NetworkShape& shape);

class Network {
 public:
  // Initial parameters by He, drawn from the seed. REQUIRES: is_possible(shape).
  Network(const NetworkShape& shape, std::uint64_t seed);
  ~Network();
  Network(Network&& other) noexcept;
  Network& operator=(Network&& other) noexcept;

  const NetworkShape& shape() const { return shape_; }

  // Logarithms of the probabilities of the classes, up to a constant. One image at a time, so that
  // the result does not depend on other images. REQUIRES: an image of the shape.
  std::vector<double> logits(std::span<const float> image);

  // All learned parameters, including the means and variances of the normalisation.
  std::vector<float> parameters();
  // False for another count, or a number that is not finite; nothing is changed then.
  bool set_parameters(std::span<const float> parameters);

  // Mean cross entropy of a batch, and its derivative by every parameter, in their order. REQUIRES:
  // at least two images.
  struct Slope {
    double loss = 0.0;
    std::vector<float> gradient;
  };
  Slope slope(std::span<const std::span<const float>> images, std::span<const std::size_t> classes);

 private:
  class Model;
  template <typename Net>
  class ModelOf;
  static std::unique_ptr<Model> make(const NetworkShape& shape, std::uint64_t seed);

  NetworkShape shape_;
  std::unique_ptr<Model> model_;
};

}  // namespace rayloc
