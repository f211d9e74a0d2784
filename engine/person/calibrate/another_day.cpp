#include "engine/person/calibrate/another_day.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/median.h"
#include "engine/observe/alignment.h"
#include "engine/observe/unit_power.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr int kFactorRounds = 20;  // a count, chosen: factors converge to a thousandth of a degree
// Share of an empty room's power that chairs and bumps may change: more is another transmitter, or
// another place of it. A ratio, chosen: moved chairs changed 0.1 to 1 % in two rooms.
constexpr double kMaxChanged = 0.1;
// A count of standard deviations, chosen: chains that differ by less are unchanged.
constexpr double kRotated = 2.0;
// [rad], 3 degrees: a bump that rotates an access point by 0.3 degrees changes its antennas' phases
// by more.
constexpr double kBump = 0.05;

// Two days of one array, aligned.
class DayFit {
 public:
  DayFit(const OfdmGrid& grid, std::vector<Value> before, std::vector<Value> after)
      : tones_(grid.size()),
        aligner_(grid),
        before_(std::move(before)),
        after_(std::move(after)),
        weight_(before_.size(), 1.0),
        turn_(before_.size() / grid.size(), 1.0) {
    align_by_one_chain();
    for (int round = 0; round < kFactorRounds; ++round) {
      fit_factors();
      align();
      weigh();
    }
    fit_factors();
  }

  const std::vector<Value>& turn() const { return turn_; }

  // Share of a chain's power, on the later day, that its factor does not explain.
  double left(std::size_t row) const {
    double off = 0.0;
    double power = 0.0;
    for (std::size_t j = row * tones_; j < (row + 1) * tones_; ++j) {
      off += std::norm(after_[j] - turn_[row] * before_[j]);
      power += std::norm(after_[j]);
    }
    return power > 0.0 ? off / power : 1.0;
  }

  // The same for all chains together.
  double left() const {
    double sum = 0.0;
    for (std::size_t row = 0; row < turn_.size(); ++row) {
      sum += left(row) / static_cast<double>(turn_.size());
    }
    return sum;
  }

 private:
  // Chains at unknown phases would cancel: the one with the best correlation gives the delay.
  void align_by_one_chain() {
    Alignment best;
    for (std::size_t row = 0; row < turn_.size(); ++row) {
      const Alignment own =
          aligner_.align(std::span(before_).subspan(row * tones_, tones_),
                         std::span<const Value>(after_).subspan(row * tones_, tones_));
      if (own.correlation > best.correlation) {
        best = own;
      }
    }
    best.factor = 1.0;
    aligner_.apply(best, after_);
  }

  void fit_factors() {
    for (std::size_t row = 0; row < turn_.size(); ++row) {
      Value along;
      double power = 0.0;
      for (std::size_t j = row * tones_; j < (row + 1) * tones_; ++j) {
        along += weight_[j] * std::conj(before_[j]) * after_[j];
        power += weight_[j] * std::norm(before_[j]);
      }
      turn_[row] = power > 0.0 ? along / power : Value();
    }
  }

  void align() {
    std::vector<Value> expected(before_.size());
    for (std::size_t j = 0; j < expected.size(); ++j) {
      expected[j] = turn_[j / tones_] * before_[j];
    }
    Alignment alignment = aligner_.align(expected, after_);
    alignment.factor = 1.0;
    aligner_.apply(alignment, after_);
  }

  // A tone with a much larger difference than most tones has little weight for the chain.
  void weigh() {
    for (std::size_t row = 0; row < turn_.size(); ++row) {
      std::vector<double> off;
      for (std::size_t j = row * tones_; j < (row + 1) * tones_; ++j) {
        off.push_back(std::norm(after_[j] - turn_[row] * before_[j]));
      }
      const double usual = std::max(median(off), 1e-30);
      for (std::size_t k = 0; k < tones_; ++k) {
        weight_[row * tones_ + k] = 1.0 / (1.0 + off[k] / usual);
      }
    }
  }

  std::size_t tones_;
  Aligner aligner_;
  std::vector<Value> before_;
  std::vector<Value> after_;
  std::vector<double> weight_;
  std::vector<Value> turn_;
};

ChainGains times(ChainGains gains, const std::vector<Value>& factor) {
  const std::size_t tones = gains.grid.size();
  for (std::size_t j = 0; j < gains.gain.size(); ++j) {
    gains.gain[j] *= factor[j / tones];
  }
  scale_to_unit(gains.gain);
  return gains;
}

}  // namespace

bool RotatedChains::is_rotated() const {
  for (std::size_t row = 1; row < turn.size(); ++row) {
    const double known = std::hypot(std::hypot(sigma[row], sigma[0]), kBump);
    if (std::abs(std::arg(turn[row])) > kRotated * known) {
      return true;
    }
  }
  return false;
}

Expected<RotatedChains> compare_days(const OfdmGrid& grid,
                                     const std::vector<Value>& before,
                                     const std::vector<Value>& after) {
  RAYLOC_CHECK(!before.empty() && before.size() == after.size() &&
               before.size() % grid.size() == 0);
  const DayFit fit(grid, before, after);
  RotatedChains chains;
  chains.turn = fit.turn();
  chains.changed = fit.left();
  if (!(chains.changed < kMaxChanged)) {
    return bad_input(
        "the empty rooms of the two days have too little in common: " +
        std::to_string(std::lround(100.0 * std::min(chains.changed, 1.0))) +
        " % of the received CSI differs; was the transmitter moved, or is it another radio?");
  }
  double level = 0.0;
  for (const Value& one : chains.turn) {
    level += std::norm(one) / static_cast<double>(chains.turn.size());
  }
  const Value common = std::polar(std::sqrt(level), std::arg(chains.turn.front()));
  for (std::size_t row = 0; row < chains.turn.size(); ++row) {
    chains.turn[row] /= common;
    // A change of the room has about the same error at all tones: an amount equal to the residual
    // may have been attributed to the chain.
    chains.sigma.push_back(std::sqrt(fit.left(row)));
  }
  return chains;
}

ChainGains rotated(ChainGains gains, const RotatedChains& chains) {
  return times(std::move(gains), chains.turn);
}

ChainGains derotated(ChainGains gains, const RotatedChains& chains) {
  std::vector<Value> back;
  back.reserve(chains.turn.size());
  for (const Value& one : chains.turn) {
    back.push_back(std::abs(one) > 0.0 ? 1.0 / one : Value(1.0));
  }
  return times(std::move(gains), back);
}

}  // namespace rayloc
