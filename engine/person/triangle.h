// The lower triangle of a Hermitian matrix by rows, including its diagonal.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace rayloc {

// Number of values of a triangle of n rows.
inline std::size_t triangle_size(std::size_t n) { return n * (n + 1) / 2; }

// sigma += weight * s s^H, from row and column `first` on.
inline void add_outer(double weight,
                      std::span<const std::complex<double>> s,
                      std::size_t first,
                      std::vector<std::complex<double>>& sigma) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    std::complex<double>* row = sigma.data() + triangle_size(first + i) + first;
    const std::complex<double> left = weight * s[i];
    for (std::size_t j = 0; j <= i; ++j) {
      row[j] += left * std::conj(s[j]);
    }
  }
}

}  // namespace rayloc
