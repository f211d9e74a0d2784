#include "engine/paper/descent.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/parallel.h"

namespace rayloc::paper {
namespace {

using LossOfPosition = std::function<LossInPlan(const Vec3d&)>;

struct DrawnLoss {
  Vec3d position;
  LossInPlan loss;
};

double squared_plan_distance(const Vec3d& a, const Vec3d& b) {
  const double x = a.x - b.x;
  const double y = a.y - b.y;
  return x * x + y * y;
}

std::vector<DrawnLoss> draw(const LossOfPosition& loss,
                            const Vec3d& centre,
                            double deviation,
                            const PlanBounds& bounds,
                            std::size_t count,
                            std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, deviation);
  std::vector<DrawnLoss> samples(count);
  for (DrawnLoss& sample : samples) {
    const double x = centre.x + normal(random);
    const double y = centre.y + normal(random);
    sample.position = bounds.nearest({x, y, centre.z});
  }
  parallel_for(count, 1, [&](std::size_t i) { samples[i].loss = loss(samples[i].position); });
  return samples;
}

// Gradient of the smoothed loss.
std::array<double, 2> smoothed_gradient(const std::vector<DrawnLoss>& samples,
                                        const Vec3d& centre,
                                        double deviation,
                                        double alpha) {
  std::array<double, 2> gradient{};
  const double share = 1.0 / static_cast<double>(samples.size());
  for (const DrawnLoss& sample : samples) {
    const double square = squared_plan_distance(sample.position, centre);
    const double weight = share * std::exp(-0.5 * square / (deviation * deviation)) *
                          std::exp(-alpha * sample.loss.value);
    gradient[0] += weight * sample.loss.by_x;
    gradient[1] += weight * sample.loss.by_y;
  }
  return gradient;
}

double decay_of_deviation(const std::vector<DrawnLoss>& samples,
                          const Vec3d& centre,
                          double alpha) {
  const auto nearest =
      std::min_element(samples.begin(), samples.end(), [&](const DrawnLoss& a, const DrawnLoss& b) {
        return squared_plan_distance(a.position, centre) <
               squared_plan_distance(b.position, centre);
      });
  // B is in [0, 1], so no exponential overflows.
  const auto exponential = [&](const DrawnLoss& sample) {
    return std::exp(std::exp(-alpha * sample.loss.value));
  };
  double sum = 0.0;
  for (const DrawnLoss& sample : samples) {
    sum += exponential(sample);
  }
  return 2.0 / (1.0 + std::exp(exponential(*nearest) / sum));
}

}  // namespace

Expected<void> validate(const DescentOptions& options) {
  const auto refuse = [](const char* what) { return make_error(ErrorKind::kUsage, what); };
  const auto is_positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (options.iterations < 0 || options.positions == 0) {
    return refuse("the paper's descent takes 0 or more iterations of 1 or more positions");
  }
  if (!is_positive(options.variance) || !is_positive(options.least_deviation) ||
      !is_positive(options.rate) || !is_positive(options.rmsprop.least)) {
    return refuse("variances, deviations and rates of the paper's descent are more than 0");
  }
  if (!(options.alpha >= 0.0) || !std::isfinite(options.alpha)) {
    return refuse("alpha of the paper's descent is 0 or more");
  }
  const auto is_share = [](double x) { return x >= 0.0 && x < 1.0; };
  if (!is_share(options.rmsprop.decay) || !is_share(options.rmsprop.momentum)) {
    return refuse("decay and momentum of the descent are from 0 to below 1");
  }
  return {};
}

Vec3d PlanBounds::nearest(const Vec3d& position) const {
  return {std::clamp(position.x, min.x, max.x), std::clamp(position.y, min.y, max.y), position.z};
}

Descent descend(const LossOfPosition& loss,
                const Vec3d& start,
                const PlanBounds& bounds,
                const DescentOptions& options,
                std::mt19937_64& random) {
  const double widest = std::sqrt(options.variance);
  Descent at{bounds.nearest(start), options.is_smoothed ? widest : 0.0};
  Rmsprop steps({options.rate, options.rate}, options.rmsprop);
  for (int t = 0; t < options.iterations; ++t) {
    std::array<double, 2> gradient{};
    if (options.is_smoothed) {
      const auto samples = draw(loss, at.position, at.deviation, bounds, options.positions, random);
      gradient = smoothed_gradient(samples, at.position, at.deviation, options.alpha);
      if (!options.is_deviation_fixed) {
        const double share = static_cast<double>(t) / options.iterations;
        at.deviation = widest - decay_of_deviation(samples, at.position, options.alpha) * share *
                                    (widest - options.least_deviation);
      }
    } else {
      const LossInPlan here = loss(at.position);
      gradient = {here.by_x, here.by_y};
    }
    std::array<double, 2> plan = {at.position.x, at.position.y};
    steps.step(gradient, plan);
    at.position = bounds.nearest({plan[0], plan[1], at.position.z});
  }
  return at;
}

}  // namespace rayloc::paper
