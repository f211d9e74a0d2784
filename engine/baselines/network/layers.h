// Layers that dlib lacks, in the form that dlib requires; for network.cpp only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iosfwd>

#include <dlib/dnn.h>

#include "engine/baselines/network/network.h"

namespace rayloc {

// Images with a shape that is set at run time.
struct PlainImage {
  const float* values = nullptr;
  ImageShape shape;
};

class PlainImages {
 public:
  using input_type = PlainImage;

  template <typename Iterator>
  void to_tensor(Iterator begin, Iterator end, dlib::resizable_tensor& data) const {
    const ImageShape& shape = begin->shape;
    data.set_size(end - begin,
                  static_cast<long long>(shape.channels),
                  static_cast<long long>(shape.rows),
                  static_cast<long long>(shape.columns));
    float* out = data.host_write_only();
    for (Iterator image = begin; image != end; ++image) {
      out = std::copy_n(image->values, shape.size(), out);
    }
  }

  friend void serialize(const PlainImages& /*layer*/, std::ostream& /*out*/) {}
  friend void deserialize(PlainImages& /*layer*/, std::istream& /*in*/) {}
  friend std::ostream& operator<<(std::ostream& out, const PlainImages& /*layer*/) { return out; }
};

// A 3 x 3 convolution of each channel with its own filter, zero-padded at the border; every
// STRIDE-th column. Parameters: nine for each channel, then their offsets.
template <long STRIDE>
class Depthwise {
 public:
  template <typename Subnet>
  void setup(const Subnet& below) {
    channels_ = below.get_output().k();
    parameters_.set_size(channels_ * (kTaps + 1));
    parameters_ = 0.0F;
  }

  template <typename Subnet>
  void forward(const Subnet& below, dlib::resizable_tensor& output) {
    const dlib::tensor& in = below.get_output();
    const long columns = (in.nc() + STRIDE - 1) / STRIDE;
    output.set_size(in.num_samples(), in.k(), in.nr(), columns);
    const float* weight = parameters_.host();
    const float* from = in.host();
    float* to = output.host_write_only();
    const long plane = in.nr() * in.nc();
    for (long i = 0; i < in.num_samples() * in.k(); ++i, from += plane) {
      const float* taps = weight + (i % channels_) * kTaps;
      const float offset = weight[channels_ * kTaps + i % channels_];
      for (long r = 0; r < in.nr(); ++r) {
        for (long c = 0; c < columns; ++c) {
          float sum = offset;
          each_tap(in, r, c, [&](long at, long tap) { sum += from[at] * taps[tap]; });
          *to++ = sum;
        }
      }
    }
  }

  template <typename Subnet>
  void backward(const dlib::tensor& slope, Subnet& below, dlib::tensor& parameter_slope) {
    const dlib::tensor& in = below.get_output();
    const float* weight = parameters_.host();
    const float* from = in.host();
    const float* given = slope.host();
    float* below_slope = below.get_gradient_input().host();
    parameter_slope = 0.0F;
    float* own = parameter_slope.host();
    const long plane = in.nr() * in.nc();
    for (long i = 0; i < in.num_samples() * in.k(); ++i, from += plane, below_slope += plane) {
      const float* taps = weight + (i % channels_) * kTaps;
      float* tap_slope = own + (i % channels_) * kTaps;
      float& offset_slope = own[channels_ * kTaps + i % channels_];
      for (long r = 0; r < in.nr(); ++r) {
        for (long c = 0; c < slope.nc(); ++c) {
          const float g = *given++;
          offset_slope += g;
          each_tap(in, r, c, [&](long at, long tap) {
            tap_slope[tap] += g * from[at];
            below_slope[at] += g * taps[tap];
          });
        }
      }
    }
  }

  const dlib::tensor& get_layer_params() const { return parameters_; }
  dlib::tensor& get_layer_params() { return parameters_; }
  long outputs() const { return channels_; }

  friend void serialize(const Depthwise& /*layer*/, std::ostream& /*out*/) {}
  friend void deserialize(Depthwise& /*layer*/, std::istream& /*in*/) {}
  friend std::ostream& operator<<(std::ostream& out, const Depthwise& /*layer*/) { return out; }

 private:
  static constexpr long kTaps = 9;  // of a filter, a count

  // Calls `use` for the taps inside the image, about row r and the c-th column of the output.
  template <typename Use>
  static void each_tap(const dlib::tensor& in, long r, long c, const Use& use) {
    for (long dr = -1; dr <= 1; ++dr) {
      const long row = r + dr;
      if (row < 0 || row >= in.nr()) {
        continue;
      }
      for (long dc = -1; dc <= 1; ++dc) {
        const long column = c * STRIDE + dc;
        if (column >= 0 && column < in.nc()) {
          use(row * in.nc() + column, 3 * (dr + 1) + dc + 1);
        }
      }
    }
  }

  long channels_ = 0;
  dlib::resizable_tensor parameters_;
};

// Batch normalisation with running means and variances as parameters, saved and restored like all
// others. A single image is normalised with them, a batch with its own, which update them.
// Parameters: scale, offset, mean, variance of each channel.
class ChannelNorm {
 public:
  template <typename Subnet>
  void setup(const Subnet& below) {
    const long channels = below.get_output().k();
    part_ = dlib::alias_tensor(1, channels, 1, 1);
    parameters_.set_size(4 * channels);
    parameters_ = 0.0F;
    part_(parameters_, 0) = 1.0F;
    part_(parameters_, 3 * part_.size()) = 1.0F;
  }

  template <typename Subnet>
  void forward(const Subnet& below, dlib::resizable_tensor& output) {
    const dlib::tensor& in = below.get_output();
    const std::size_t n = part_.size();
    auto scale = part_(parameters_, 0);
    auto offset = part_(parameters_, n);
    auto kept_mean = part_(parameters_, 2 * n);
    auto kept_variance = part_(parameters_, 3 * n);
    if (in.num_samples() == 1) {
      dlib::tt::batch_normalize_conv_inference(
          kEpsilon, output, in, scale, offset, kept_mean, kept_variance);
      return;
    }
    dlib::resizable_tensor mean;
    dlib::resizable_tensor variance;
    dlib::tt::batch_normalize_conv(
        kEpsilon, output, means_, inverse_, 1.0, mean, variance, in, scale, offset);
    const float* now = mean.host();
    const float* spread = variance.host();
    for (std::size_t i = 0; i < n; ++i) {
      float& kept = kept_mean.host()[i];
      kept += kForget * (now[i] - kept);
      float& kept_spread = kept_variance.host()[i];
      kept_spread += kForget * (spread[i] - kept_spread);
    }
  }

  template <typename Subnet>
  void backward(const dlib::tensor& slope, Subnet& below, dlib::tensor& parameter_slope) {
    parameter_slope = 0.0F;  // means and variances are not trained by descent
    auto scale = part_(parameters_, 0);
    auto scale_slope = part_(parameter_slope, 0);
    auto offset_slope = part_(parameter_slope, part_.size());
    dlib::tt::batch_normalize_conv_gradient(kEpsilon,
                                            slope,
                                            means_,
                                            inverse_,
                                            below.get_output(),
                                            scale,
                                            below.get_gradient_input(),
                                            scale_slope,
                                            offset_slope);
  }

  const dlib::tensor& get_layer_params() const { return parameters_; }
  dlib::tensor& get_layer_params() { return parameters_; }

  friend void serialize(const ChannelNorm& /*layer*/, std::ostream& /*out*/) {}
  friend void deserialize(ChannelNorm& /*layer*/, std::istream& /*in*/) {}
  friend std::ostream& operator<<(std::ostream& out, const ChannelNorm& /*layer*/) { return out; }

 private:
  static constexpr double kEpsilon = 1e-5;  // added to a variance, usual value
  static constexpr float kForget = 0.1F;    // weight of a batch in the running means, usual value

  dlib::alias_tensor part_;
  dlib::resizable_tensor parameters_;
  dlib::resizable_tensor means_;
  dlib::resizable_tensor inverse_;  // 1 / standard deviation
};

template <long STRIDE, typename Subnet>
using depthwise = dlib::add_layer<Depthwise<STRIDE>, Subnet>;
template <typename Subnet>
using channel_norm = dlib::add_layer<ChannelNorm, Subnet>;

}  // namespace rayloc
