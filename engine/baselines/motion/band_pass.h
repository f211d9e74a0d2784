// BandPass: a Butterworth filter that passes motion and removes static paths and noise.
//
// Fourth order, second-order sections, initialised in the steady state, run forward and backward
// over the signal extended oddly by kContinued samples at each end: zero delay. The same as SciPy's
// butter(4, ..., 'band') and sosfiltfilt().
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

namespace rayloc {

class BandPass {
 public:
  static constexpr std::size_t kContinued = 27;  // samples, as in SciPy for four sections

  // Frequencies in Hz. REQUIRES: 0 < low < high < rate / 2.
  BandPass(double low, double high, double rate);

  // REQUIRES: more than kContinued samples.
  std::vector<std::complex<double>> filtered(std::span<const std::complex<double>> signal) const;

 private:
  struct Section {
    std::array<double, 3> b{};
    std::array<double, 2> a{};  // a1 and a2; a0 is 1
  };
  void run(std::vector<std::complex<double>>& signal) const;

  std::array<Section, 4> sections_;
};

}  // namespace rayloc
