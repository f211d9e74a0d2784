#include "engine/baselines/network/network.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "engine/base/check.h"
#include "engine/baselines/network/layers.h"

namespace rayloc {
namespace {

// Three poolings or strides by two leave at least one of so many columns.
constexpr std::size_t kMinColumns = 8;  // a count
constexpr std::size_t kLeNetRows = 5;   // a count: its last pooling covers all

// --- The networks, from the image at the end to the loss at the beginning. ---------------------

using LeNet = dlib::loss_multiclass_log<
    dlib::fc<1,
             dlib::relu<dlib::fc<
                 128,
                 dlib::max_pool<
                     kLeNetRows,
                     2,
                     kLeNetRows,
                     2,
                     dlib::relu<dlib::con<
                         64,
                         3,
                         3,
                         1,
                         1,
                         dlib::max_pool<
                             1,
                             2,
                             1,
                             2,
                             dlib::relu<dlib::con<
                                 32,
                                 3,
                                 5,
                                 1,
                                 1,
                                 dlib::max_pool<
                                     1,
                                     2,
                                     1,
                                     2,
                                     dlib::relu<dlib::con<16, 3, 5, 1, 1, PlainImages>>>>>>>>>>>>>;

template <long OUT, long STRIDE, typename Subnet>
using separable = dlib::relu<
    channel_norm<dlib::con<OUT, 1, 1, 1, 1, dlib::relu<channel_norm<depthwise<STRIDE, Subnet>>>>>>;

using MobileNet = dlib::loss_multiclass_log<
    dlib::fc<1,
             dlib::avg_pool_everything<
                 separable<256,
                           2,
                           separable<128,
                                     1,
                                     separable<128,
                                               2,
                                               separable<64,
                                                         1,
                                                         dlib::relu<channel_norm<dlib::add_layer<
                                                             dlib::con_<32, 3, 3, 1, 2, 1, 1>,
                                                             PlainImages>>>>>>>>>>;

// --- Initialisation: deviations of sqrt(2 / inputs) [He], offsets 0. ---------------------------

template <typename Layer>
long outputs_of(const Layer& /*layer*/) {
  return 0;  // without weights
}
template <long N, long R, long C, int SY, int SX, int PY, int PX>
long outputs_of(const dlib::con_<N, R, C, SY, SX, PY, PX>& layer) {
  return layer.num_filters();
}
template <unsigned long N, dlib::fc_bias_mode MODE>
long outputs_of(const dlib::fc_<N, MODE>& layer) {
  return static_cast<long>(layer.get_num_outputs());
}
template <long STRIDE>
long outputs_of(const Depthwise<STRIDE>& layer) {
  return layer.outputs();
}

// Normal deviates that are the same with every standard library.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : random_(seed) {}
  double operator()() {
    constexpr double kTwoPi = 6.283185307179586;  // [rad]
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(kTwoPi * uniform());
  }

 private:
  // Uniform in (0, 1].
  double uniform() { return (static_cast<double>(random_() >> 11U) + 1.0) * 0x1p-53; }
  std::mt19937_64 random_;
};

struct Begin {
  Normal normal;

  template <typename Layer>
  void operator()(Layer& layer) {
    const auto outputs = static_cast<std::size_t>(outputs_of(layer));
    dlib::tensor& parameters = layer.get_layer_params();
    if (outputs == 0) {
      return;
    }
    const std::size_t weights = parameters.size() - outputs;
    const double sigma =
        std::sqrt(2.0 * static_cast<double>(outputs) / static_cast<double>(weights));
    float* values = parameters.host();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      values[i] = i < weights ? static_cast<float>(sigma * normal()) : 0.0F;
    }
  }
};

}  // namespace

class Network::Model {
 public:
  Model() = default;
  virtual ~Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;
  virtual std::vector<double> logits(const PlainImage& image) = 0;
  virtual std::vector<float> parameters() = 0;
  virtual void set_parameters(std::span<const float> parameters) = 0;
  virtual Slope slope(const std::vector<PlainImage>& images,
                      const std::vector<unsigned long>& classes) = 0;
};

template <typename Net>
class Network::ModelOf : public Network::Model {
 public:
  ModelOf(const NetworkShape& shape, std::uint64_t seed) {
    net_.subnet().layer_details().set_num_outputs(static_cast<long>(shape.classes));
    const std::vector<float> nothing(shape.image.size());
    logits({nothing.data(), shape.image});  // the layers derive their sizes
    dlib::visit_computational_layers(net_, Begin{Normal(seed)});
  }

  std::vector<double> logits(const PlainImage& image) override {
    net_.to_tensor(&image, &image + 1, input_);
    const dlib::tensor& out = net_.subnet().forward(input_);
    return {out.host(), out.host() + out.size()};
  }

  std::vector<float> parameters() override {
    std::vector<float> all;
    dlib::visit_layer_parameters(
        net_, [&](dlib::tensor& t) { all.insert(all.end(), t.host(), t.host() + t.size()); });
    return all;
  }

  void set_parameters(std::span<const float> parameters) override {
    std::size_t at = 0;
    dlib::visit_layer_parameters(net_, [&](dlib::tensor& t) {
      std::copy_n(parameters.data() + at, t.size(), t.host());
      at += t.size();
    });
  }

  Slope slope(const std::vector<PlainImage>& images,
              const std::vector<unsigned long>& classes) override {
    Slope slope;
    net_.to_tensor(images.begin(), images.end(), input_);
    slope.loss = net_.compute_parameter_gradients(input_, classes.begin());
    dlib::visit_layer_parameter_gradients(net_, [&](dlib::tensor& t) {
      slope.gradient.insert(slope.gradient.end(), t.host(), t.host() + t.size());
    });
    return slope;
  }

 private:
  Net net_;
  dlib::resizable_tensor input_;
};

bool is_possible(const NetworkShape& shape) {
  return shape.classes > 1 && shape.image.channels > 0 && shape.image.columns >= kMinColumns &&
         (shape.kind == NetworkKind::kMobileNet ? shape.image.rows > 0
                                                : shape.image.rows == kLeNetRows);
}

std::unique_ptr<Network::Model> Network::make(const NetworkShape& shape, std::uint64_t seed) {
  if (shape.kind == NetworkKind::kLeNet) {
    return std::make_unique<ModelOf<LeNet>>(shape, seed);
  }
  return std::make_unique<ModelOf<MobileNet>>(shape, seed);
}

Network::Network(const NetworkShape& shape, std::uint64_t seed) : shape_(shape) {
  RAYLOC_CHECK(is_possible(shape));
  model_ = make(shape, seed);
}

Network::~Network() = default;
Network::Network(Network&& other) noexcept = default;
Network& Network::operator=(Network&& other) noexcept = default;

std::vector<double> Network::logits(std::span<const float> image) {
  RAYLOC_CHECK(image.size() == shape_.image.size());
  return model_->logits({image.data(), shape_.image});
}

std::vector<float> Network::parameters() { return model_->parameters(); }

bool Network::set_parameters(std::span<const float> parameters) {
  const bool finite = std::all_of(
      parameters.begin(), parameters.end(), [](float value) { return std::isfinite(value); });
  if (!finite || parameters.size() != model_->parameters().size()) {
    return false;
  }
  model_->set_parameters(parameters);
  return true;
}

Network::Slope Network::slope(std::span<const std::span<const float>> images,
                              std::span<const std::size_t> classes) {
  RAYLOC_CHECK(images.size() > 1 && images.size() == classes.size());
  std::vector<PlainImage> plain;
  for (const std::span<const float> image : images) {
    RAYLOC_CHECK(image.size() == shape_.image.size());
    plain.push_back({image.data(), shape_.image});
  }
  return model_->slope(plain, {classes.begin(), classes.end()});
}

}  // namespace rayloc
