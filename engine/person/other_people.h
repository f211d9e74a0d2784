// OtherPeople: people known to be in the room, for the likelihood of one more (METHODS B5). In the
// coordinates of PersonLikelihood they add a mean, and an error of covariance S S^H:
//
//   mu' = mu + added,   Sigma' = Sigma + S S^H
//
// S has few columns, so a Gaussian with co-occupants needs no new factorisation: with B = W S and
// M = I + B^H B, a^H Sigma'^-1 b = (W a)^H (I - B M^-1 B^H) (W b), and det Sigma' =
// det Sigma det M (matrix inversion and determinant lemmas).
//
// Waves that interact with two people are left out.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/gaussian/whitened_gaussian.h"

namespace rayloc {

struct OtherPeople {
  // A count, chosen: the strongest error components of the others.
  static constexpr std::size_t kMaxColumns = 6;
  std::vector<std::complex<double>> added;                // [coordinate]; empty: no other people
  std::vector<std::vector<std::complex<double>>> spread;  // S, [column][coordinate]

  bool empty() const { return added.empty(); }
};

// One Gaussian with co-occupants. Holds a reference to the Gaussian.
class AccompaniedGaussian {
 public:
  // REQUIRES: `co_occupants` is not empty and has at most kMaxColumns columns.
  AccompaniedGaussian(const WhitenedGaussian& gaussian, const OtherPeople& co_occupants);

  // (I - B M^-1 B^H) u, for u = W y.
  std::vector<std::complex<double>> reduced(std::span<const std::complex<double>> u) const;
  // u^H (I - B M^-1 B^H) u
  double power(std::span<const std::complex<double>> u) const;
  // W added
  std::span<const std::complex<double>> shift() const { return shift_; }
  // ln det M
  double log_determinant() const { return log_determinant_; }

 private:
  using Column = std::array<std::complex<double>, OtherPeople::kMaxColumns>;

  void solve(std::span<std::complex<double>> x) const;
  Column along(std::span<const std::complex<double>> u) const;  // C^-1 B^H u

  const WhitenedGaussian& gaussian_;
  std::size_t columns_;
  std::array<std::vector<std::complex<double>>, OtherPeople::kMaxColumns> b_;
  std::array<Column, OtherPeople::kMaxColumns> factor_{};  // C
  std::vector<std::complex<double>> shift_;
  double log_determinant_ = 0.0;
};

}  // namespace rayloc
