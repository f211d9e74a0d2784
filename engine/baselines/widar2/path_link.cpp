#include "engine/baselines/widar2/path_link.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/baselines/paths/turn.h"

namespace rayloc {
namespace {

// Differences from window to window with a cost of 1 or 1/2, and the maximum cost: measured with a
// prototype.
constexpr double kRateStep = 0.3;          // [m/s]
constexpr double kDelayStep = 15e-9;       // [s]
constexpr double kPsiStep = 0.6;           // [rad]
constexpr double kMaxCost = 8.0;           // a logarithm, measured with a prototype
constexpr double kMinEnergyShare = 1e-12;  // of the energy

double square(double x) { return x * x; }

double edge(const MotionPath& from, const MotionPath& to) {
  return std::min(kMaxCost,
                  square((to.rate - from.rate) / kRateStep) +
                      0.5 * square((to.delay - from.delay) / kDelayStep) +
                      square(wrapped(to.psi - from.psi) / kPsiStep));
}

}  // namespace

std::optional<MotionPath> PathLink::add(std::vector<MotionPath> paths) {
  double energy = 0.0;
  for (const MotionPath& path : paths) {
    energy += path.energy;
  }
  Window window{std::move(paths), {}, {}};
  for (const MotionPath& path : window.paths) {
    double best = 0.0;
    std::size_t before = 0;
    if (!received_.empty()) {
      best = std::numeric_limits<double>::infinity();
      const Window& last = received_.back();
      for (std::size_t i = 0; i < last.paths.size(); ++i) {
        const double cost = last.cost[i] + edge(last.paths[i], path);
        if (cost < best) {
          best = cost;
          before = i;
        }
      }
    }
    const double share = energy > 0.0 ? path.energy / energy : 1.0;
    window.cost.push_back(best - std::log(std::max(share, kMinEnergyShare)));
    window.before.push_back(before);
  }
  const double least = *std::min_element(window.cost.begin(), window.cost.end());
  for (double& cost : window.cost) {
    cost -= least;  // keeps the sums small
  }
  received_.push_back(std::move(window));
  if (received_.size() <= windows_) {
    return std::nullopt;
  }
  const auto& last = received_.back().cost;
  auto at = static_cast<std::size_t>(std::min_element(last.begin(), last.end()) - last.begin());
  for (std::size_t i = received_.size() - 1; i > received_.size() - 1 - windows_; --i) {
    at = received_[i].before[at];
  }
  const MotionPath decoded = received_[received_.size() - 1 - windows_].paths[at];
  if (received_.size() > windows_ + 1) {
    received_.pop_front();
  }
  return decoded;
}

}  // namespace rayloc
