// AccessPointFusion: joint likelihood of several access points at a place if each may be wrong
// (METHODS B7: log-likelihoods add while no access point is wrong).
//
// An access point that is obstructed, was moved, or has changed chains still fits some place in the
// room about as well as usual: its likelihood then carries no information on the position. With l_i
// its log-likelihood of a place, t the exponent of the likelihood, Z_i the mean of exp(t l_i) over
// the room and e_i the probability that it is wrong,
//
//   exp(t l(x)) = prod_i ((1 - e_i) exp(t l_i(x)) + e_i Z_i) - prod_i e_i Z_i
//
// An access point whose density at a place is far below e_i of the mean adds nothing there, so one
// cannot outvote the others, and two that contradict each other leave the places of both. The last
// term carries no information on the position; it is part of the outlier probability, as is the
// burst of a device outside the room.
//
// Between right and wrong is an access point that was bumped since its calibration, by millimetres
// or a degree: its map is still valid, but less sharp than stated. So its density exp(t l_i(x)) /
// Z_i is a mixture over the remaining sharpness (kBlunted), each component with its own mean over
// the room: the largest exponent dominates while the others agree within the stated errors, a wider
// one otherwise.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/grid/cell_set.h"

namespace rayloc {

// Prior probabilities. An obstructed line of sight is not a fault: the likelihood itself allows for
// it (kObstructed).
struct FaultPrior {
  double access_point = 0.015;  // an access point carries no information on the position
  double outlier = 0.015;       // the device is not in the area
};

// Possible losses of sharpness of an access point: its log-likelihood is multiplied by
// `exponent` with this probability. Standard deviations grow by its inverse root: two and four
// times.
struct Blunted {
  double exponent;
  double probability;
};
// Chosen: a loss of one half is common, more is rare. With much more of it an access point that
// contradicts the others would hardly count.
inline constexpr std::array<Blunted, 2> kBlunted = {{{1.0 / 4.0, 0.25}, {1.0 / 16.0, 0.02}}};

class AccessPointFusion {
 public:
  // maps: [access point][cell], log-likelihoods of all cells of the room, or of a sample that
  // represents it; not empty. faulty: e_i of each access point; in (0, 1).
  AccessPointFusion(std::span<const std::vector<double>> maps,
                    double likelihood_exponent,
                    std::span<const double> faulty,
                    const CellWeights& weights = {});

  // One number for full sharpness, then one for each of kBlunted.
  using Terms = std::array<double, 1 + kBlunted.size()>;
  // log_means: [access point], ln of the mean of exp(e t l_i) over the room, with the exponent
  // e = 1 of full sharpness and those of kBlunted; not empty.
  static AccessPointFusion of_means(std::span<const Terms> log_means,
                                    double likelihood_exponent,
                                    std::span<const double> faulty);

  std::size_t size() const { return log_mean_.size(); }

  // l of a place; `of_each`: l_i. Never below kNothing, which represents zero mass.
  static constexpr double kNothing = -1e4;
  double log_likelihood(std::span<const double> of_each) const;

  // The probability that access point i is wrong, or has lost all of its sharpness but the last of
  // kBlunted, for a device at a place with this log-likelihood.
  double faulty(std::size_t i, double log_likelihood) const;

  // ln of 1 - e_i, of e_i Z_i, and of the factors of the powers of exp(t l_i).
  double log_right(std::size_t i) const { return log_right_[i]; }
  double log_wrong(std::size_t i) const { return log_wrong_[i]; }
  const Terms& log_factor(std::size_t i) const { return log_factor_[i]; }

  // Outlier probability; log_mean: logarithm of the mean of exp(t l) over the room.
  double outlier(double log_mean, double prior) const;

 private:
  explicit AccessPointFusion(double likelihood_exponent)
      : likelihood_exponent_(likelihood_exponent) {}

  void add(const Terms& log_means, double faulty);
  // ln of (1 - e_i) Z_i times each mixture component: full sharpness, then kBlunted.
  Terms right(std::size_t i, double log_likelihood) const;

  double likelihood_exponent_;
  std::vector<double> log_mean_;  // ln Z_i
  std::vector<Terms> log_factor_;
  std::vector<double> log_right_;
  std::vector<double> log_wrong_;
  double log_nothing_ = 0.0;  // ln prod e_i Z_i
};

// ln (e^a + e^b).
double log_add(double a, double b);
// ln of the mean of exp(likelihood_exponent l).
double log_mean_exp(std::span<const double> log_likelihood,
                    double likelihood_exponent,
                    const CellWeights& weights = {});

}  // namespace rayloc
