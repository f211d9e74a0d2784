// ElevationTable: complex coefficients as smooth functions of the cosine of an elevation, from
// samples at equal steps: cubic pieces with matching slopes (Hermite, slopes by differences of
// fourth order), so that derivatives are continuous.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/complex.h"

namespace rayloc {

// Minimum size of a table, a count, chosen: slopes need five neighbours.
inline constexpr std::size_t kMinTableSamples = 16;

class ElevationTable {
 public:
  // A value is weight[0] node[0] + ... + weight[3] node[3], its derivative the same
  // with slope_weight.
  struct Place {
    std::array<const Complex<double>*, 4> node;  // value, slope, next value, next slope
    std::array<double, 4> weight;
    std::array<double, 4> slope_weight;
  };

  ElevationTable() = default;
  // `samples[i]`: the coefficients at cosine lowest + i (1 - lowest) / (samples.size() - 1).
  // REQUIRES: at least 5 samples, all of one size; 0 < lowest < 1.
  ElevationTable(double lowest, std::vector<std::vector<Complex<double>>> samples);

  std::size_t width() const { return width_; }  // coefficients of a sample
  // Outside the table the value is that at its end.
  Place at(double cosine) const;
  // Values, and derivatives by the cosine, of the coefficients from `first` on; `slopes` may be
  // empty.
  static void read(const Place& place,
                   std::size_t first,
                   std::span<Complex<double>> values,
                   std::span<Complex<double>> slopes);

 private:
  double lowest_ = 0.0;
  double step_ = 1.0;
  std::size_t count_ = 0;
  std::size_t width_ = 0;
  std::vector<Complex<double>> nodes_;  // by sample: values, then slopes times the step
};

}  // namespace rayloc
