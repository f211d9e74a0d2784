#include "engine/calibrate/chain_refit.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/median.h"
#include "engine/base/parallel.h"
#include "engine/calibrate/chain_ripple.h"
#include "engine/calibrate/log_odds.h"
#include "engine/likelihood/point_arrays.h"
#include "engine/observe/alignment.h"
#include "engine/observe/unit_power.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr int kRefitIterations = 8;  // a count, chosen: bounds the time of a refit
// Additional reflections beyond those of the likelihood; tried, and kept where they explain more.
// Their effect averages out over a survey, but not over one point: where the strong paths to an
// antenna cancel, the residual of these reflections changes the phase.
constexpr int kMoreDepth = 1;
// [s], change of a chain's delay in a power cycle: a clock divider that starts at another edge
// changes phases by multiples of a quarter cycle, delays by a fraction of a sample at most.
constexpr double kDelaySigma = 0.3e-9;
// Shares of the calibrated tolerance of surfaces. The calibrated value comes from a coarse scan
// over all surfaces; the value that explains these points best is equally valid.
constexpr std::array<double, 3> kTolerances = {1.0, 0.5, 0.0};

double power(std::span<const Value> values) {
  double sum = 0.0;
  for (const Value& v : values) {
    sum += std::norm(v);
  }
  return sum;
}

std::vector<Value> through(const std::vector<Value>& gain, const std::vector<Value>& expected) {
  std::vector<Value> product(gain.size());
  for (std::size_t j = 0; j < gain.size(); ++j) {
    product[j] = gain[j] * expected[j];
  }
  return product;
}

// Sums over the points for one chain: measured against gain times expected, per tone.
struct ChainSums {
  std::vector<Value> cross;
  std::vector<double> power;
  double measured = 0.0;

  Value along() const { return std::accumulate(cross.begin(), cross.end(), Value()); }
  double expected() const { return std::accumulate(power.begin(), power.end(), 0.0); }

  // Share of the measured power that one factor on top of the gain explains.
  double correlation() const {
    const double own = expected();
    return own > 0.0 && measured > 0.0 ? std::norm(along()) / (own * measured) : 0.0;
  }

  // Magnitude of that factor.
  double factor() const { return std::abs(along()) / expected(); }
};

// Factors and delays of the chains on top of gains that are known except for these.
class FactorFit {
 public:
  FactorFit(const OfdmGrid& grid, std::vector<ArrayPair> pairs, std::vector<Value> gain)
      : tones_(grid.size()), aligner_(grid), pairs_(std::move(pairs)), gain_(std::move(gain)) {
    const double middle = 0.5 * (grid.tone_index.front() + grid.tone_index.back());
    for (const auto tone : grid.tone_index) {
      angular_.push_back(2.0 * std::numbers::pi * grid.spacing_hz * (tone - middle));
    }
    delay_.resize(rows());
    log_gain_.resize(rows());
    for (ArrayPair& pair : pairs_) {
      scale_to_unit(pair.measured);
      scale_to_unit(pair.expected);
    }
  }

  void run() {
    align_by_one_chain();
    take_common_gain();
    for (int iteration = 0; iteration < kRefitIterations; ++iteration) {
      for (std::size_t row = 0; row < rows(); ++row) {
        improve(row);
      }
      align();
    }
    scale_to_unit(gain_);
  }

  const std::vector<Value>& gain() const { return gain_; }

  // [rad], for each chain; a chain of a point counts as one independent value, because errors of
  // the room are nearly the same at all tones.
  std::vector<double> sigma() const {
    std::vector<double> result;
    for (std::size_t row = 0; row < rows(); ++row) {
      const double share = std::clamp(sums(row).correlation(), 1e-6, 1.0);
      const auto points = static_cast<double>(pairs_.size());
      result.push_back(
          std::min(std::sqrt((1.0 - share) / (2.0 * share * points)), std::numbers::pi));
    }
    return result;
  }

 private:
  std::size_t rows() const { return gain_.size() / tones_; }

  // With unknown phases, the sum over all chains would cancel. One chain therefore determines the
  // delay and phase of each point, the same chain for all points.
  void align_by_one_chain() {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t row = 0; row < rows(); ++row) {
      double sum = 0.0;
      for (const ArrayPair& pair : pairs_) {
        const std::span measured = std::span(pair.measured).subspan(row * tones_, tones_);
        sum += align_row(pair, row).correlation * power(measured);
      }
      if (sum > most) {
        most = sum;
        best = row;
      }
    }
    for (ArrayPair& pair : pairs_) {
      aligner_.apply(align_row(pair, best), pair.measured);
    }
  }

  Alignment align_row(const ArrayPair& pair, std::size_t row) const {
    const auto model = through(gain_, pair.expected);
    return aligner_.align(std::span(model).subspan(row * tones_, tones_),
                          std::span(pair.measured).subspan(row * tones_, tones_));
  }

  // A change common to all chains contains no information on them: their common amplitude,
  // estimated from the chains that are explained best, is set to the earlier one.
  void take_common_gain() {
    double weights = 0.0;
    double sum = 0.0;
    for (std::size_t row = 0; row < rows(); ++row) {
      const ChainSums own = sums(row);
      const double share = own.correlation();
      if (share > 0.0) {
        weights += sharpness(share);
        sum += sharpness(share) * std::log(own.factor());
      }
    }
    for (Value& value : gain_) {
      value *= weights > 0.0 ? std::exp(sum / weights) : 1.0;
    }
  }

  void align() {
    parallel_for(pairs_.size(), 4, [&](std::size_t i) {
      ArrayPair& pair = pairs_[i];
      aligner_.apply(aligner_.align(through(gain_, pair.expected), pair.measured), pair.measured);
    });
  }

  ChainSums sums(std::size_t row) const {
    ChainSums sums{std::vector<Value>(tones_), std::vector<double>(tones_), 0.0};
    for (const ArrayPair& pair : pairs_) {
      for (std::size_t k = 0; k < tones_; ++k) {
        const std::size_t j = row * tones_ + k;
        const Value model = gain_[j] * pair.expected[j];
        sums.cross[k] += pair.measured[j] * std::conj(model);
        sums.power[k] += std::norm(model);
        sums.measured += std::norm(pair.measured[j]);
      }
    }
    return sums;
  }

  // Inverse variance of phase and ln |factor| of a chain of which that share is explained.
  double sharpness(double share) const {
    const double explained = std::clamp(share, 0.0, 1.0 - 1e-6);
    return 2.0 * explained / (1.0 - explained) * static_cast<double>(pairs_.size());
  }

  // One Newton step for the delay; the factor in closed form.
  void improve(std::size_t row) {
    const ChainSums now = sums(row);
    const Value sum = now.along();
    const double own = now.expected();
    if (!(own > 0.0) || !(std::abs(sum) > 0.0)) {
      return;
    }
    const Value rotated = std::conj(sum) / std::abs(sum);
    double slope = 0.0;
    double curvature = 0.0;
    for (std::size_t k = 0; k < tones_; ++k) {
      slope += angular_[k] * (rotated * now.cross[k]).imag();
      curvature += angular_[k] * angular_[k] * now.power[k] * std::abs(sum) / own;
    }
    const double sharp = sharpness(now.correlation());
    const double weight = sharp / std::max(std::abs(sum), 1e-12);  // spread over the tones
    const double prior = 1.0 / (kDelaySigma * kDelaySigma);
    const double step =
        (weight * slope - prior * delay_[row]) / std::max(weight * curvature + prior, 1e-300);
    delay_[row] += step;
    // ln |factor| is as accurate as its phase.
    const double stiffness = 1.0 / (kChainGainSigma * kChainGainSigma);
    const double rise =
        (sharp * std::log(std::abs(sum) / own) - stiffness * log_gain_[row]) / (sharp + stiffness);
    log_gain_[row] += rise;
    for (std::size_t k = 0; k < tones_; ++k) {
      gain_[row * tones_ + k] *=
          sum / std::abs(sum) * std::polar(std::exp(rise), angular_[k] * step);
    }
  }

  std::size_t tones_;
  Aligner aligner_;
  std::vector<double> angular_;  // [rad/s], of each tone relative to the middle
  std::vector<ArrayPair> pairs_;
  std::vector<Value> gain_;
  std::vector<double> delay_;     // [s], advance added to each chain
  std::vector<double> log_gain_;  // ln of the factor's magnitude, of each chain
};

// A refit under one assumption on the accuracy of the surfaces.
struct Attempt {
  ChainRefit refit;
  double tolerance = 0.0;
  double sum = 0.0;  // sum of the correlations
};

class Refit {
 public:
  Refit(const RoomModel& room, std::size_t access_point, std::span<const ReferencePoint> points)
      : access_point_(room.access_points[access_point]),
        grid_(room.grid),
        arrays_(room, access_point),
        aligner_(room.grid) {
    for (const ReferencePoint& point : points) {
      RAYLOC_CHECK(point.h.size() == access_point_.gains.gain.size());
      auto rays =
          point.usual.empty() ? arrays_.rays(point.position, point.device) : std::vector<Ray>{};
      if (!rays.empty() || !point.usual.empty()) {
        points_.push_back(&point);
        rays_.push_back(std::move(rays));
      }
    }
  }

  bool empty() const { return points_.empty(); }

  Attempt best() const {
    Attempt best;
    for (const double share : kTolerances) {
      Attempt one = attempt(share * access_point_.error.plan_tolerance);
      if (best.refit.points == 0 || one.sum > best.sum) {
        best = std::move(one);
      }
    }
    return best;
  }

  // Adds the phase error due to the uncertainty of the places, per chain relative to the first.
  void add_place(double place_sigma, Attempt& attempt) const {
    std::vector<double> sigma(attempt.refit.sigma.size());
    for (const ReferencePoint* point : points_) {
      if (!point->usual.empty()) {
        continue;
      }
      const auto own =
          arrays_.place_phase_sigma(point->position, point->device, attempt.tolerance, place_sigma);
      for (std::size_t m = 0; m < sigma.size(); ++m) {
        sigma[m] = std::hypot(sigma[m], own[m]);
      }
    }
    for (std::size_t m = 0; m < sigma.size(); ++m) {
      attempt.refit.sigma[m] =
          std::hypot(attempt.refit.sigma[m], sigma[m] / static_cast<double>(points_.size()));
    }
  }

 private:
  Attempt attempt(double tolerance) const {
    // The antennas and their mutual coupling are unchanged by a power cycle.
    ChainGains gains{grid_, access_point_.rx_chains, {}, access_point_.gains.coupling};
    std::vector<ArrayPair> pairs;
    std::vector<std::vector<Value>> fields;
    for (std::size_t s = 0; s < points_.size(); ++s) {
      const std::vector<Value>& usual = points_[s]->usual;
      fields.push_back(usual.empty() ? arrays_.expected(rays_[s], tolerance) : usual);
      pairs.push_back({points_[s]->h, fields.back()});
      apply_coupling(gains, pairs.back().expected);
    }
    Attempt one;
    one.tolerance = tolerance;
    one.refit.points = points_.size();
    const bool were_all_received_before =
        std::none_of(points_.begin(), points_.end(), [](const ReferencePoint* point) {
          return point->usual.empty();
        });
    one.refit.ripple = were_all_received_before || points_.size() >= kRipplePoints;
    if (one.refit.ripple) {
      ChainRipple ripple = chain_ripple(aligner_, grid_, pairs);
      gains.gain = std::move(ripple.gain);
      one.refit.sigma = std::move(ripple.sigma);
    }
    // Per-tone gains fit the few points they come from: their residuals give no valid sigma.
    if (points_.size() < kRipplePoints) {
      FactorFit fit(grid_, pairs, access_point_.gains.gain);
      fit.run();
      one.refit.sigma = fit.sigma();
      if (!one.refit.ripple) {
        gains.gain = fit.gain();
      }
    }
    std::vector<double> correlations;
    for (std::size_t s = 0; s < pairs.size(); ++s) {
      remove_gains(gains, pairs[s].measured);
      correlations.push_back(aligner_.align(fields[s], pairs[s].measured).correlation);
      one.sum += correlations.back();
    }
    one.refit.gains = std::move(gains);
    one.refit.fit = median(std::move(correlations));
    return one;
  }

  const RoomAccessPoint access_point_;
  const OfdmGrid grid_;
  const PointArrays arrays_;
  const Aligner aligner_;
  std::vector<const ReferencePoint*> points_;
  std::vector<std::vector<Ray>> rays_;
};

RoomModel traced_deeper(RoomModel room) {
  room.trace.max_depth += kMoreDepth;
  return room;
}

std::string share_text(double share) {
  std::array<char, 16> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), share, std::chars_format::fixed, 3);
  return {text.data(), end.ptr};
}

bool is_far_below(double fit, const UsualFit& usual) {
  constexpr double kQuartiles = 1.349;  // between the quartiles of a normal distribution, in sigmas
  const double spread = std::max(
      (log_odds(usual.upper_quartile) - log_odds(usual.lower_quartile)) / kQuartiles, kMinSpread);
  return log_odds(fit) < log_odds(usual.median) - kFarBelowUsual * spread;
}

Expected<void> check_phases(const RoomAccessPoint& ap, const ChainRefit& refit, double most) {
  for (std::size_t m = 1; m < refit.sigma.size(); ++m) {
    if (const double sigma = std::hypot(refit.sigma[m], refit.sigma[0]); sigma > most) {
      return bad_input("access point " + ap.id + ": the phase of core " +
                       std::to_string(ap.rx_chains[m]) + " would be known to " +
                       std::to_string(std::lround(sigma * 180.0 / std::numbers::pi)) +
                       " degrees only: the room explains too little of its CSI; give other known "
                       "places (--points), or record the empty room with the fixed transmitter "
                       "before the next power cycle (rayloc reference)");
    }
  }
  return {};
}

}  // namespace

Expected<ChainRefit> refit_chains(const RoomModel& room,
                                  std::size_t access_point,
                                  std::span<const ReferencePoint> points,
                                  const ChainRefitOptions& options) {
  const RoomAccessPoint& ap = room.access_points.at(access_point);
  RAYLOC_CHECK(!ap.gains.empty());
  const Refit usual(room, access_point, points);
  const Refit deeper(traced_deeper(room), access_point, points);
  if (usual.empty()) {
    return bad_input("access point " + ap.id + ": no ray of the room reaches it from " +
                     std::to_string(points.size()) + " known places; are they inside the room?");
  }
  Attempt best = usual.best();
  Attempt other = deeper.best();
  const bool is_deeper = other.sum > best.sum;
  if (is_deeper) {
    best = std::move(other);
  }
  if (options.usual && is_far_below(best.refit.fit, *options.usual)) {
    return bad_input("access point " + ap.id + ": new chain gains explain " +
                     share_text(best.refit.fit) + " of its CSI (median of " +
                     std::to_string(best.refit.points) + " known places), the calibration " +
                     share_text(options.usual->median) +
                     ": the room or the access point has changed, or a place is wrong; check the "
                     "places, or calibrate anew");
  }
  RAYLOC_TRY(check_phases(ap, best.refit, options.most_sigma));
  (is_deeper ? deeper : usual).add_place(options.place_sigma, best);
  return std::move(best.refit);
}

}  // namespace rayloc
