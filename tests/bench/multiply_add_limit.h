// The complex multiply-adds that one core can do: the baseline of the channel kernel.
#pragma once

#include <array>
#include <complex>
#include <cstddef>

namespace rayloc::bench {

// Two pairs of complex arrays, real and imaginary parts apart, that fit into the first-level cache.
struct ComplexFactors {
  static constexpr std::size_t kSize = 256;
  static constexpr std::size_t kPasses = 16;  // so many that starting and ending do not count

  ComplexFactors();

  struct Column {
    std::array<double, kSize> re;
    std::array<double, kSize> im;
  };
  alignas(64) std::array<Column, 2> x;
  alignas(64) std::array<Column, 2> y;
};

// kPasses times x_a . y_b for a, b in {0, 1}: 4 kSize kPasses complex multiply-adds, of four real
// ones each, with the widest vectors of the processor. Eight independent accumulators hide the
// latency, and each loaded number is used twice, so that only the multipliers limit the rate.
std::array<std::complex<double>, 4> products(const ComplexFactors& factors);

}  // namespace rayloc::bench
