#include "engine/paper/delay_spread.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"

namespace rayloc::paper {
namespace {

using Value = std::complex<double>;

constexpr double kStep = 5e6;  // [Hz]

std::vector<std::pair<std::size_t, std::size_t>> pairs_at(const OfdmGrid& grid, int lag) {
  const std::vector<std::int16_t>& tone = grid.tone_index;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = 0; k < tone.size(); ++k) {
    const auto other = std::lower_bound(tone.begin(), tone.end(), tone[k] + lag);
    if (other != tone.end() && *other == tone[k] + lag) {
      pairs.emplace_back(k, static_cast<std::size_t>(other - tone.begin()));
    }
  }
  return pairs;
}

// Tone distance, closest to the desired one and at most half the band, that exists in the grid.
int lag_of(const OfdmGrid& grid) {
  const int band = grid.tone_index.back() - grid.tone_index.front();
  const int most = std::max(1, band / 2);
  const int wanted = std::clamp(static_cast<int>(std::lround(kStep / grid.spacing_hz)), 1, most);
  for (int off = 0; off <= band; ++off) {
    for (const int lag : {wanted - off, wanted + off}) {
      if (lag >= 1 && !pairs_at(grid, lag).empty()) {
        return lag;
      }
    }
  }
  return band;
}

}  // namespace

DelaySpread::DelaySpread(const OfdmGrid& grid, double floor) : tones_(grid.size()), floor_(floor) {
  RAYLOC_CHECK(grid.size() >= 2 && floor > 0.0);
  const int lag = lag_of(grid);
  pair_ = pairs_at(grid, lag);
  angular_step_ = 2.0 * std::numbers::pi * grid.spacing_hz * lag;
}

DelaySpread::Correlation DelaySpread::correlate(std::span<const Value> row) const {
  Correlation result;
  for (const auto& [a, b] : pair_) {
    result.cross += row[b] * std::conj(row[a]);
    result.lower_power += std::norm(row[a]);
    result.upper_power += std::norm(row[b]);
  }
  result.is_silent = !(result.lower_power > 0.0 && result.upper_power > 0.0);
  if (!result.is_silent) {
    result.square = std::norm(result.cross) / result.lower_power / result.upper_power;
  }
  return result;
}

double DelaySpread::spread(const Correlation& correlation) const {
  // Rounding may lift |c| of a single path above 1.
  return std::sqrt(std::max(1.0 - correlation.square, 0.0) + floor_) / angular_step_;
}

std::vector<double> DelaySpread::of(std::span<const Value> h) const {
  RAYLOC_CHECK(h.size() % tones_ == 0);
  std::vector<double> result;
  for (std::size_t row = 0; row < h.size(); row += tones_) {
    const Correlation correlation = correlate(h.subspan(row, tones_));
    result.push_back(correlation.is_silent ? 0.0 : spread(correlation));
  }
  return result;
}

std::vector<Value> DelaySpread::adjoint(std::span<const Value> h,
                                        std::span<const double> spread_adjoint) const {
  RAYLOC_CHECK(h.size() == spread_adjoint.size() * tones_);
  std::vector<Value> adjoint(h.size());
  for (std::size_t antenna = 0; antenna < spread_adjoint.size(); ++antenna) {
    const auto row = h.subspan(antenna * tones_, tones_);
    const auto out = std::span(adjoint).subspan(antenna * tones_, tones_);
    const Correlation c = correlate(row);
    if (c.is_silent) {
      continue;
    }
    // d(spread) = -d|c|^2 / (2 (2 pi D)^2 spread), and
    // d|c|^2 = 2 Re(conj(cross) d cross) / (P_a P_b) - |c|^2 (dP_a / P_a + dP_b / P_b).
    const double by_square =
        -spread_adjoint[antenna] / (2.0 * angular_step_ * angular_step_ * spread(c));
    const Value by_cross = 2.0 * by_square * c.cross / c.lower_power / c.upper_power;
    const double by_lower = -2.0 * by_square * c.square / c.lower_power;
    const double by_upper = -2.0 * by_square * c.square / c.upper_power;
    for (const auto& [a, b] : pair_) {
      out[b] += by_cross * row[a] + by_upper * row[b];
      out[a] += std::conj(by_cross) * row[b] + by_lower * row[a];
    }
  }
  return adjoint;
}

}  // namespace rayloc::paper
