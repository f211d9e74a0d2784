#include "engine/baselines/motion/path_rate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include "engine/baselines/paths/turn.h"
#include "engine/observe/savitzky_golay.h"

namespace rayloc {
namespace {

constexpr int kSmoothingPasses = 3;  // a count, of the published release
constexpr std::size_t kChord = 2;    // samples from end to end of a tangent
constexpr double kMinRange = 1e-3;   // [rad/s], chosen: lower limit of a rotation's range

int odd_samples(double seconds, double step_s) {
  return 2 * static_cast<int>(std::lround(0.5 * (seconds / step_s - 1.0))) + 1;
}

// Means over `window` samples around each one; fewer at the ends.
std::vector<double> moving_mean(const std::vector<double>& values, int window) {
  std::vector<double> sums(values.size() + 1);
  std::partial_sum(values.begin(), values.end(), sums.begin() + 1);
  const auto half = static_cast<std::size_t>(window / 2);
  std::vector<double> means(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i < half ? 0 : i - half;
    const std::size_t to = std::min(values.size(), i + half + 1);
    means[i] = (sums[to] - sums[from]) / static_cast<double>(to - from);
  }
  return means;
}

std::vector<std::complex<double>> smoothed(std::span<const std::complex<double>> ratio,
                                           int window) {
  std::vector<double> position(ratio.size());
  std::iota(position.begin(), position.end(), 0.0);
  const SavitzkyGolay smoother(position, {window, 2});
  std::vector<std::complex<double>> q(ratio.begin(), ratio.end());
  for (int i = 0; i < kSmoothingPasses; ++i) {
    q = smoother.smooth(q);
  }
  return q;
}

}  // namespace

std::vector<PathRate> path_rates(std::span<const std::complex<double>> ratio,
                                 double step_s,
                                 double wavelength,
                                 const PathRateOptions& options) {
  if (ratio.size() <= kChord + 1) {
    return std::vector<PathRate>(ratio.size());
  }
  const auto q = smoothed(ratio, odd_samples(options.smoothing_s, step_s));
  // Rotation rate of the tangent between sample i and the next [rad/s].
  std::vector<double> turning(q.size());
  for (std::size_t i = 0; i + kChord + 1 < q.size(); ++i) {
    const auto now = q[i + kChord] - q[i];
    const auto next = q[i + kChord + 1] - q[i + 1];
    turning[i + 1] = std::arg(next * std::conj(now)) / step_s;
  }
  turning.front() = turning[1];
  for (std::size_t i = q.size() - kChord; i < q.size(); ++i) {
    turning[i] = turning[q.size() - kChord - 1];
  }
  const int window = odd_samples(options.sign_s, step_s);
  const std::vector<double> sense = moving_mean(turning, window);
  std::vector<double> rate(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) {
    rate[i] =
        -std::copysign(std::abs(turning[i]), sense[i]) * wavelength / (2.0 * std::numbers::pi);
  }
  rate = moving_mean(rate, window / 2);
  std::vector<PathRate> all(q.size());
  const auto half = static_cast<std::size_t>(window / 2);
  for (std::size_t i = 0; i < q.size(); ++i) {
    const std::size_t from = i < half ? 0 : i - half;
    const std::size_t to = std::min(q.size(), i + half + 1);
    const auto [least, most] =
        std::minmax_element(turning.begin() + static_cast<std::ptrdiff_t>(from),
                            turning.begin() + static_cast<std::ptrdiff_t>(to));
    all[i] = {rate[i], 1.0 / (std::max(*most - *least, kMinRange) * window)};
  }
  return all;
}

}  // namespace rayloc
