// AccessPointFusion: what several access points say of a place together, when each may be wrong
// (METHODS B7: log-likelihoods add, while nothing is wrong).
//
// An access point that is covered, was moved, or whose chains have changed still fits somewhere in
// the room, about as well as it always does: what it says of the place is then worth nothing. With
// l_i its log-likelihood of a place, t the exponent of the likelihood, Z_i the mean of exp(t l_i)
// over the room and e_i the probability that it is wrong,
//
//   exp(t l(x)) = prod_i ((1 - e_i) exp(t l_i(x)) + e_i Z_i) - prod_i e_i Z_i
//
// An access point whose density at a place is far below e_i of the mean adds nothing there, so that
// one cannot outvote the others, and two that contradict each other leave both of their places. The
// last term is what says nothing of the place; it belongs to "elsewhere", with the burst of a
// device that is not in the room at all.
//
// Between right and wrong lies an access point that was bumped since it was calibrated, by
// millimetres or a degree: it still knows the room, but less sharply than it says. So its density
// exp(t l_i(x)) / Z_i is a mixture over what is left of its sharpness (kBlunted), each with its own
// mean over the room: that of the largest exponent, while the others agree to within what it
// states; a wider one, where they do not.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace rayloc {

// Probabilities before anything is heard. A direct way that is covered is no fault: the likelihood
// itself allows for it (kCovered).
struct FaultPrior {
  double access_point = 0.015;  // an access point says nothing of the place
  double elsewhere = 0.015;     // the device is not in the area
};

// How many cells of a room each value of a map stands for: 1 for the first `ones` of them, which
// are looked at themselves, and `others` for those behind, which are a sample of the rest.
struct CellWeights {
  std::size_t ones = std::numeric_limits<std::size_t>::max();
  double others = 1.0;

  double of(std::size_t n) const { return n < ones ? 1.0 : others; }
};

// What may be left of the sharpness of an access point: its log-likelihood is multiplied by
// `exponent` with this probability. Standard deviations grow by its inverse root: two and four
// times.
struct Blunted {
  double exponent;
  double probability;
};
// Chosen: a loss of one half is common, more is rare. With much more of it one that contradicts the
// others would hardly count.
inline constexpr std::array<Blunted, 2> kBlunted = {{{1.0 / 4.0, 0.25}, {1.0 / 16.0, 0.02}}};

class AccessPointFusion {
 public:
  // maps: [access point][cell], log-likelihoods of all cells of the room, or of some that stand for
  // it; not empty. faulty: of each access point, e_i; in (0, 1).
  AccessPointFusion(std::span<const std::vector<double>> maps,
                    double likelihood_exponent,
                    std::span<const double> faulty,
                    const CellWeights& weights = {});

  std::size_t size() const { return log_mean_.size(); }

  // l of a place; `of_each`: l_i. Never below kNothing, which is no mass.
  static constexpr double kNothing = -1e4;
  double log_likelihood(std::span<const double> of_each) const;

  // Of a place: the probability that access point i is wrong, or has lost all of its sharpness but
  // the last of kBlunted, when the device is there.
  double faulty(std::size_t i, double log_likelihood) const;

  // ln of 1 - e_i, of e_i Z_i, and of what the powers of exp(t l_i) are multiplied by: that of the
  // whole sharpness, then of each of kBlunted.
  using Terms = std::array<double, 1 + kBlunted.size()>;
  double log_right(std::size_t i) const { return log_right_[i]; }
  double log_wrong(std::size_t i) const { return log_wrong_[i]; }
  const Terms& log_factor(std::size_t i) const { return log_factor_[i]; }

  // Probability of "elsewhere"; log_mean: of exp(t l) over the room, its logarithm.
  double elsewhere(double log_mean, double prior) const;

 private:
  // ln of (1 - e_i) Z_i times what each of the mixture has: the whole sharpness, then kBlunted.
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
