// BoxFactor: the covariance of a box and its whitener, in vectors of doubles. Most of the time to
// make a box is spent here. Results differ by rounding between kinds of processors.
//
// Used by one thread at a time.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace rayloc {

class BoxFactor {
 public:
  // Starts with zero. dimension: of an observation, at least 1.
  explicit BoxFactor(std::size_t dimension);

  std::size_t dimension() const { return dimension_; }
  // Rows of a column in memory: the dimension, rounded up to whole vectors.
  static std::size_t padded(std::size_t dimension) {
    return (dimension + kRows - 1) / kRows * kRows;
  }

  // Adds a matrix times its conjugate transpose: [column][row], padded with zeros.
  // REQUIRES: equal sizes, a multiple of padded(dimension()).
  void add(std::span<const double> re, std::span<const double> im);
  // Adds to an entry of the lower triangle.
  void add(std::size_t row, std::size_t column, std::complex<double> value);

  // Replaces the covariance by its whitener W: Sigma^-1 = W^H W, a lower triangle with a real
  // diagonal. REQUIRES: the covariance is positive definite.
  void factorise();

  // After factorise().
  std::complex<double> whitener(std::size_t row, std::size_t column) const;
  double log_determinant() const;  // of the covariance
  std::vector<std::complex<double>> whiten(std::span<const std::complex<double>> x) const;

  // Matrices in split form, [line][entry of the line], padded.
  struct Lines {
    std::vector<double> re;
    std::vector<double> im;
  };

 private:
  static constexpr std::size_t kRows = 8;  // a count: doubles of the widest vectors

  std::size_t dimension_;
  Lines columns_;  // of the covariance, then of its triangle
  Lines rows_;     // of the whitener
};

// exp(-2 pi j x) of each x [turns], |x| < 1e6. REQUIRES: equal sizes.
void unit_phasors(std::span<const double> turns, std::span<double> re, std::span<double> im);

}  // namespace rayloc
