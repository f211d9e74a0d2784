#include "engine/calibrate/joint/surface_scan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/base/parallel.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr double kMinScanPower = 1e-3;    // of the strongest surface's power
constexpr std::size_t kMaxSurfaces = 40;  // largest number of scanned surfaces
// Other surfaces that would move are held: an alternative is likelier than the scan indicates.
constexpr double kHeldOthers = 0.5;

// Minus the logarithm of the posterior at each value of one unknown, up to a constant; empty when
// no sample depends on it.
std::vector<double> profile(const JointContext& context,
                            double floor,
                            const JointState& state,
                            std::uint32_t unknown,
                            std::span<const double> values) {
  const std::vector<double> change = context.change(state.values);
  std::vector<double> moved(values.begin(), values.end());  // as changes from the traced room
  for (double& value : moved) {
    value -= context.traced_at[unknown];
  }
  std::vector<std::vector<double>> each(context.samples.size());
  parallel_for(context.samples.size(), 1, [&](std::size_t i) {
    const TracedSample& traced = *context.samples[i].traced;
    each[i] = context.model.scan(
        traced, *context.samples[i].measured, {change, state.survey[traced.point]}, unknown, moved);
  });
  std::vector<double> sum(values.size());
  bool any = false;
  for (const auto& unexplained : each) {
    any = any || !unexplained.empty();
    for (std::size_t j = 0; j < unexplained.size(); ++j) {
      sum[j] += kEvidence * std::log(floor + unexplained[j]);
    }
  }
  if (!any) {
    return {};
  }
  for (std::size_t j = 0; j < values.size(); ++j) {
    const double off = values[j] / context.unknowns[unknown].sigma;
    sum[j] += 0.5 * off * off;
  }
  return sum;
}

// Candidate offsets of a surface about `centre`.
std::vector<double> places(double centre, double range, double step) {
  std::vector<double> result;
  const auto steps = static_cast<int>(std::lround(range / step));
  for (int i = -steps; i <= steps; ++i) {
    result.push_back(centre + step * i);
  }
  return result;
}

}  // namespace

std::vector<double> surface_power(std::span<const TracedSample> samples, const Scene& scene) {
  std::vector<double> power(scene.surfaces().size());
  for (const TracedSample& sample : samples) {
    double total = std::numeric_limits<double>::min();
    for (const auto& rays : sample.rays) {
      for (const LinearRay& ray : rays) {
        total += std::norm(ray.amplitude);
      }
    }
    for (const auto& rays : sample.rays) {
      for (const LinearRay& ray : rays) {
        for (const RayTerm& term : sample.terms_of(ray)) {
          if (term.unknown < power.size()) {
            power[term.unknown] += std::norm(ray.amplitude) / total;
          }
        }
      }
    }
  }
  for (double& one : power) {
    one /= static_cast<double>(std::max<std::size_t>(samples.size(), 1));
  }
  return power;
}

std::vector<std::uint32_t> strongest_surfaces(std::span<const double> power,
                                              double share,
                                              std::size_t most) {
  std::vector<std::uint32_t> order(power.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return power[a] > power[b];
  });
  const double least = share * power[order.front()];
  order.resize(std::min(most, order.size()));
  std::erase_if(order, [&](std::uint32_t surface) { return power[surface] < least; });
  return order;
}

void scan_surfaces(const JointContext& context,
                   std::span<const double> power,
                   const ScanOptions& options,
                   JointState& state) {
  for (const std::uint32_t surface : strongest_surfaces(power, kMinScanPower, kMaxSurfaces)) {
    const std::uint32_t unknown = context.unknowns.surface_offset(surface);
    const auto values = places(state.values[unknown], options.range, options.step);
    const auto cost = profile(context, options.floor, state, unknown, values);
    if (!cost.empty()) {
      state.values[unknown] = values[static_cast<std::size_t>(
          std::min_element(cost.begin(), cost.end()) - cost.begin())];
    }
  }
}

void widen_by_other_cycles(const JointContext& context,
                           double floor,
                           const JointState& state,
                           std::vector<double>& sigma) {
  constexpr double kRange = 0.06;  // [m]: two half waves at 5 GHz
  constexpr double kStep = 0.001;  // [m], chosen: a thirtieth of a half wave at 5 GHz
  for (std::uint32_t i = 0; i < context.unknowns.size(); ++i) {
    if (context.unknowns[i].kind != Unknown::Kind::kSurfaceOffset || sigma[i] <= 0.0) {
      continue;
    }
    const auto values = places(state.values[i], kRange, kStep);
    const auto cost = profile(context, floor, state, i, values);
    if (cost.empty()) {
      continue;
    }
    const double least = *std::min_element(cost.begin(), cost.end());
    double mass = 0.0;
    double spread = 0.0;
    for (std::size_t j = 0; j < values.size(); ++j) {
      const double weight = std::exp(-kHeldOthers * (cost[j] - least));
      const double off = values[j] - state.values[i];
      mass += weight;
      spread += weight * off * off;
    }
    sigma[i] = std::max(sigma[i], std::sqrt(spread / mass));
  }
}

}  // namespace rayloc
