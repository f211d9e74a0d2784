#include "engine/baselines/paths/path_count.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rayloc {
namespace {

constexpr double kMinEigenvalueShare = 0.03;  // of the largest, a ratio: counts as a path
constexpr double kDrop = 1.58;                // from one eigenvalue to the next, a ratio: 2 dB

std::size_t by_drop(std::span<const double> e) {
  std::size_t last = 0;
  std::size_t steepest = 1;
  double most = 0.0;
  for (std::size_t i = 0; i + 1 < e.size() && i < kMaxPaths; ++i) {
    if (!(e[i] > kMinEigenvalueShare * e[0])) {
      break;
    }
    const double drop = e[i] / std::max(e[i + 1], std::numeric_limits<double>::min());
    if (drop >= kDrop) {
      last = i + 1;
    }
    if (drop > most) {
      most = drop;
      steepest = i + 1;
    }
  }
  return last > 0 ? last : steepest;
}

std::size_t by_description_length(std::span<const double> e, std::size_t snapshots) {
  const auto p = static_cast<double>(e.size());
  const auto t = static_cast<double>(snapshots);
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < e.size() && i <= kMaxPaths; ++i) {
    const auto n = static_cast<double>(e.size() - i);
    double logs = 0.0;
    double sum = 0.0;
    for (const double value : e.subspan(i)) {
      logs += std::log(std::max(value, std::numeric_limits<double>::min()));
      sum += value;
    }
    const auto k = static_cast<double>(i);
    const double length =
        -t * (logs - n * std::log(std::max(sum / n, std::numeric_limits<double>::min()))) +
        0.5 * k * (2.0 * p - k) * std::log(t);
    if (length < least) {
      least = length;
      best = i;
    }
  }
  return best;
}

}  // namespace

std::span<const std::string_view> path_count_rule_names() {
  // In the order of the rules.
  static constexpr std::array kNames = std::to_array<std::string_view>({"drop", "mdl"});
  return kNames;
}

std::size_t count_paths(std::span<const double> eigenvalues,
                        std::size_t snapshots,
                        PathCountRule rule) {
  const std::size_t count = rule == PathCountRule::kDrop
                                ? by_drop(eigenvalues)
                                : by_description_length(eigenvalues, snapshots);
  return std::clamp(count, kFewestPaths, kMaxPaths);
}

}  // namespace rayloc
