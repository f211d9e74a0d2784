#include "engine/track/place_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/work_done.h"

namespace rayloc {
namespace {

constexpr double kParts16 = 65536.0;     // of a probability, as NormalDraws::bits16
constexpr double kMovedAtRest = 0.3;     // a ratio, chosen: of the move of a resting place
constexpr float kMinLogWeight = -1e29F;  // logarithm: a place below it has no weight

std::uint32_t share16(double probability) {
  return static_cast<std::uint32_t>(std::lround(kParts16 * probability));
}

}  // namespace

// Constants of a step, the same for all places.
struct PlaceCloud::Step {
  // A walk under acceleration of spectral density q.
  struct Acceleration {
    float speed_variance;  // q t
    float covariance;      // q t^2 / 2
    float variance;        // q t^3 / 3
  };
  static Acceleration acceleration(double q, double t) {
    return {static_cast<float>(q * t),
            static_cast<float>(q * t * t / 2.0),
            static_cast<float>(q * t * t * t / 3.0)};
  }

  float seconds;
  float decay;  // of a velocity
  float rise;   // [m], deviation of the height
  Acceleration usual;
  Acceleration turning;
};

void PlaceCloud::reserve(std::size_t count) {
  for (std::vector<float>* one : {&x_, &y_, &z_, &u_, &v_, &variance_, &log_weight_}) {
    one->reserve(count);
  }
  is_resting_.reserve(count);
}

void PlaceCloud::add(const CloudPlace& place, float log_weight) {
  x_.push_back(place.x);
  y_.push_back(place.y);
  z_.push_back(place.z);
  u_.push_back(place.u);
  v_.push_back(place.v);
  variance_.push_back(place.variance);
  is_resting_.push_back(place.is_resting ? 1 : 0);
  log_weight_.push_back(log_weight);
}

CloudPlace PlaceCloud::place(std::size_t i) const {
  return {x_[i], y_[i], z_[i], u_[i], v_[i], variance_[i], is_resting_[i] != 0};
}

// The displacement from the mean path is drawn; it updates the velocity as a measurement would.
void PlaceCloud::walk(std::size_t i, const Step& step, bool has_turn, NormalDraws& draws) {
  const Step::Acceleration& q = has_turn ? step.turning : step.usual;
  const float t = step.seconds;
  const float p = variance_[i];
  const float s = p * t * t + q.variance;
  const float c = p * t + q.covariance;
  const float k = c / s;
  const float deviation = std::sqrt(s);
  const float x = deviation * draws.normal();
  const float y = deviation * draws.normal();
  x_[i] += u_[i] * t + x;
  y_[i] += v_[i] * t + y;
  u_[i] = step.decay * (u_[i] + k * x);
  v_[i] = step.decay * (v_[i] + k * y);
  variance_[i] = std::max(0.0F, step.decay * step.decay * (p + q.speed_variance - k * c));
}

void PlaceCloud::predict(double seconds,
                         const CloudMotion& motion,
                         const HeightPrior& height,
                         NormalDraws& draws) {
  RAYLOC_CHECK(seconds >= 0.0);
  if (seconds <= 0.0) {
    return;
  }
  // Per walking place: 60 operations, six floats read and written, and the mode.
  WorkDone::add(60 * size(), 49 * size());
  const Step step{static_cast<float>(seconds),
                  static_cast<float>(std::exp(-seconds / motion.velocity_time)),
                  static_cast<float>(motion.height_speed * seconds),
                  Step::acceleration(motion.acceleration, seconds),
                  Step::acceleration(motion.turn_factor * motion.acceleration, seconds)};
  const std::uint32_t switched = share16(-0.5 * std::expm1(-2.0 * motion.switching_rate * seconds));
  const std::uint32_t turning = share16(motion.turn_share);
  const std::uint32_t anew = share16(-std::expm1(-motion.height_change_rate * seconds));
  const auto first_variance = static_cast<float>(motion.speed * motion.speed);
  const auto jitter = static_cast<float>(motion.rest_jitter * std::sqrt(seconds));
  const bool is_height_known = height.sigma <= 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    // Every place draws these three, so that they do not depend on the motion.
    const bool is_switched = draws.bits16() < switched;
    const bool has_turn = draws.bits16() < turning;
    const bool is_height_new = draws.bits16() < anew;
    if (is_switched) {
      is_resting_[i] ^= 1U;
      u_[i] = 0.0F;
      v_[i] = 0.0F;
      variance_[i] = is_resting_[i] != 0 ? 0.0F : first_variance;
    }
    if (is_resting_[i] != 0) {
      x_[i] += jitter * draws.normal();
      y_[i] += jitter * draws.normal();
      continue;
    }
    walk(i, step, has_turn, draws);
    if (is_height_known) {
      continue;
    }
    z_[i] =
        is_height_new
            ? static_cast<float>(height.mean + height.sigma * static_cast<double>(draws.normal()))
            : z_[i] + step.rise * draws.normal();
  }
}

void PlaceCloud::weigh_change(double change, double odds) {
  const double scale = std::log(odds);
  const auto rest = static_cast<float>(-change * scale);
  const auto walk = static_cast<float>((change - 1.0) * scale);
  for (std::size_t i = 0; i < size(); ++i) {
    log_weight_[i] += is_resting_[i] != 0 ? rest : walk;
  }
}

std::vector<float> PlaceCloud::weights() const {
  std::vector<float> weights(size(), 0.0F);
  float top = kMinLogWeight;
  for (const float one : log_weight_) {
    top = std::max(top, one);
  }
  if (top <= kMinLogWeight) {
    return weights;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    weights[i] = std::exp(log_weight_[i] - top);
    sum += static_cast<double>(weights[i]);
  }
  const auto scale = static_cast<float>(1.0 / sum);
  for (float& one : weights) {
    one *= scale;
  }
  return weights;
}

double PlaceCloud::weigh(std::span<const float> factor) {
  RAYLOC_CHECK(factor.size() >= size());
  const std::vector<float> before = weights();
  double sum = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    sum += static_cast<double>(before[i]) * static_cast<double>(factor[i]);
  }
  if (!(sum > 0.0)) {
    return -std::numeric_limits<double>::infinity();
  }
  const double log_mean = std::log(sum);
  for (std::size_t i = 0; i < size(); ++i) {
    const double weight = static_cast<double>(before[i]) * static_cast<double>(factor[i]);
    log_weight_[i] = weight > 0.0 ? static_cast<float>(std::log(weight) - log_mean) : kNoWeight;
  }
  return log_mean;
}

double PlaceCloud::effective() const {
  double sum = 0.0;
  double squares = 0.0;
  for (const float one : weights()) {
    const auto weight = static_cast<double>(one);
    sum += weight;
    squares += weight * weight;
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

bool PlaceCloud::resample(std::size_t count,
                          const CloudMotion& motion,
                          bool is_height_known,
                          NormalDraws& draws) {
  const std::vector<float> weight = weights();
  double all = 0.0;
  std::size_t last = 0;  // with weight
  for (std::size_t i = 0; i < weight.size(); ++i) {
    all += static_cast<double>(weight[i]);
    last = weight[i] > 0.0F ? i : last;
  }
  if (!(all > 0.0) || count == 0) {
    return false;
  }
  const auto log_weight = static_cast<float>(-std::log(static_cast<double>(count)));
  const double first = draws.uniform();
  const double step = all / static_cast<double>(count);
  PlaceCloud drawn;
  drawn.reserve(count);
  std::size_t from = 0;
  auto sum = static_cast<double>(weight.front());
  for (std::size_t n = 0; n < count; ++n) {
    const double goal = (static_cast<double>(n) + first) * step;
    while (sum < goal && from < last) {
      ++from;
      sum += static_cast<double>(weight[from]);
    }
    CloudPlace one = place(from);
    const double share = one.is_resting ? kMovedAtRest : 1.0;
    one.x += static_cast<float>(share * motion.resampled.x) * draws.normal();
    one.y += static_cast<float>(share * motion.resampled.y) * draws.normal();
    if (!is_height_known) {
      one.z += static_cast<float>(share * motion.resampled.z) * draws.normal();
    }
    drawn.add(one, log_weight);
  }
  *this = std::move(drawn);
  return true;
}

double PlaceCloud::resting() const {
  const std::vector<float> weight = weights();
  double sum = 0.0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    sum += is_resting_[i] != 0 ? static_cast<double>(weight[i]) : 0.0;
  }
  return std::min(sum, 1.0);
}

std::size_t cell_of(const PlaceCloud& cloud, std::size_t i, const Grid& grid) {
  return grid.cell_at(static_cast<double>(cloud.x()[i]), static_cast<double>(cloud.y()[i]));
}

}  // namespace rayloc
