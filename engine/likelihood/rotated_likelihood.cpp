#include "engine/likelihood/rotated_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/check.h"
#include "engine/likelihood/gain_profile.h"
#include "engine/likelihood/min_power.h"

namespace rayloc {
namespace {

// Counts, chosen: half a step is below the resolution of a burst, and four chains have no more
// states than are worth evaluating.
constexpr std::size_t kSteps = 16;
constexpr std::size_t kStepsOfMany = 8;  // a count, chosen

ChainProducts products_of(const PlaceModel& place,
                          const ObservedArray::Block& block,
                          std::size_t chains) {
  return whiten_chains(place.whitener.data(), block.re, block.im, place.mean, chains);
}

// Terms of a mean's log-likelihood besides the gain profile.
float offset_of(const PlaceModel& place, std::size_t mean) {
  return (mean == 0 ? -place.open.whitened
                    : static_cast<float>(kLogObstructed) - place.obstructed.whitened) -
         static_cast<float>(place.log_determinant);
}

void raise(const PlaceModel& place,
           const ObservedArray::Block& block,
           std::size_t chains,
           std::span<const std::complex<float>> undoing,
           std::span<float> of_state,
           LaneRow& highest) {
  const std::size_t size = block.re.size();
  const ChainProducts products = products_of(place, block, chains);
  for (std::size_t mean = 0; mean * size < place.mean.size(); ++mean) {
    best_of_turns(
        products, {chains, size, mean, offset_of(place, mean), undoing}, of_state, highest);
  }
}

ChainMoments moments_of(const PlaceModel& place,
                        const ChainProducts& products,
                        std::size_t lane,
                        std::size_t size,
                        std::size_t chains) {
  const auto value = [&](const LaneSums& sums) {
    return std::complex<double>(sums.re[lane], sums.im[lane]);
  };
  ChainMoments moments;
  moments.chains = chains;
  moments.dimension = static_cast<double>(size);
  moments.mean_count = place.mean.size() / size;
  for (std::size_t n = 0; n < chains; ++n) {
    moments.power[n] = products.power[n][lane];
    for (std::size_t m = 0; m < n; ++m) {
      moments.cross[chain_pair(m, n)] = value(products.cross[chain_pair(m, n)]);
    }
    for (std::size_t k = 0; k < moments.mean_count; ++k) {
      moments.means[k].along[n] = value(products.along[k][n]);
    }
  }
  for (std::size_t k = 0; k < moments.mean_count; ++k) {
    moments.means[k].offset = offset_of(place, k);
  }
  return moments;
}

}  // namespace

RotationGrid::RotationGrid(std::size_t chains) : chains_(chains) {
  RAYLOC_CHECK(chains > 0 && chains <= kMaxChains);
  const std::size_t steps = chains > 3 ? kStepsOfMany : kSteps;
  for (std::size_t turn = 0; turn < steps; ++turn) {
    undoing_.emplace_back(std::polar(
        1.0, -2.0 * std::numbers::pi * static_cast<double>(turn) / static_cast<double>(steps)));
  }
  for (std::size_t chain = 1; chain < chains; ++chain) {
    size_ *= steps;
  }
}

double RotationGrid::step() const {
  return 2.0 * std::numbers::pi / static_cast<double>(undoing_.size());
}

std::size_t RotationGrid::turn(std::size_t state, std::size_t chain) const {
  for (std::size_t after = chain + 1; after < chains_; ++after) {
    state /= undoing_.size();
  }
  return chain == 0 ? 0 : state % undoing_.size();
}

double RotationGrid::phase(std::size_t state, std::size_t chain) const {
  return std::remainder(step() * static_cast<double>(turn(state, chain)), 2.0 * std::numbers::pi);
}

std::size_t RotationGrid::distance(std::size_t a, std::size_t b) const {
  const std::size_t steps = undoing_.size();
  std::size_t most = 0;
  for (std::size_t chain = 1; chain < chains_; ++chain) {
    const std::size_t ahead = (turn(a, chain) + steps - turn(b, chain)) % steps;
    most = std::max(most, std::min(ahead, steps - ahead));
  }
  return most;
}

std::uint8_t coarse_of_turns(const PlaceModel& place,
                             const ObservedArray& observed,
                             std::size_t chains,
                             std::span<const std::complex<float>> undoing,
                             std::span<float> of_state) {
  std::fill(of_state.begin(), of_state.end(), std::numeric_limits<float>::lowest());
  LaneRow highest;
  highest.fill(std::numeric_limits<float>::lowest());
  raise(place, observed.coarse, chains, undoing, of_state, highest);
  return ObservedArray::peak_windows(highest);
}

void log_likelihood_of_turns(const PlaceModel& place,
                             const ObservedArray& observed,
                             std::uint8_t windows,
                             const RotationGrid& grid,
                             std::span<float> of_state) {
  std::fill(of_state.begin(), of_state.end(), std::numeric_limits<float>::lowest());
  LaneRow highest;
  highest.fill(std::numeric_limits<float>::lowest());
  for (std::size_t w = 0; w < ObservedArray::kWindows; ++w) {
    if ((windows >> w & 1U) != 0) {
      raise(place, observed.windows[w], grid.chains(), grid.undoing(), of_state, highest);
    }
  }
}

// With x = Z y, Z = diag(undoing), the density of y is that of x times |det Z|^2.
double ChainMoments::log_likelihood(std::span<const std::complex<double>> undoing) const {
  double a = 0.0;
  double volume = 0.0;
  for (std::size_t n = 0; n < chains; ++n) {
    a += std::norm(undoing[n]) * power[n];
    volume += std::log(std::norm(undoing[n]));
    for (std::size_t m = 0; m < n; ++m) {
      a += 2.0 * (std::conj(undoing[m]) * undoing[n] * cross[chain_pair(m, n)]).real();
    }
  }
  double best = std::numeric_limits<double>::lowest();
  for (std::size_t k = 0; k < mean_count; ++k) {
    std::complex<double> b;
    for (std::size_t n = 0; n < chains; ++n) {
      b += undoing[n] * means[k].along[n];
    }
    best = std::max(best,
                    gain_profile(std::max(a, kMinPower), std::abs(b), dimension) + means[k].offset);
  }
  return best + dimension / static_cast<double>(chains) * volume;
}

ChainMoments ChainMoments::multiplied(std::span<const std::complex<double>> factor) const {
  ChainMoments result = *this;
  for (std::size_t n = 0; n < chains; ++n) {
    result.power[n] *= std::norm(factor[n]);
    for (std::size_t m = 0; m < n; ++m) {
      result.cross[chain_pair(m, n)] *= std::conj(factor[m]) * factor[n];
    }
    for (std::size_t k = 0; k < mean_count; ++k) {
      result.means[k].along[n] *= factor[n];
    }
  }
  return result;
}

ChainMoments chain_moments(const PlaceModel& place,
                           const ObservedArray& observed,
                           std::span<const std::complex<double>> undoing) {
  ChainMoments best;
  double highest = std::numeric_limits<double>::lowest();
  const std::size_t size = observed.coordinates();
  // Maximum over the coarse delays, then over the best window.
  const auto best_lane = [&](const ObservedArray::Block& block) {
    const ChainProducts products = products_of(place, block, undoing.size());
    std::size_t at = 0;
    double top = std::numeric_limits<double>::lowest();
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const ChainMoments moments = moments_of(place, products, lane, size, undoing.size());
      const double value = moments.log_likelihood(undoing);
      if (value > top) {
        top = value;
        at = lane;
      }
      if (value > highest) {
        highest = value;
        best = moments;
      }
    }
    return at;
  };
  best_lane(observed.windows[best_lane(observed.coarse)]);
  return best;
}

}  // namespace rayloc
