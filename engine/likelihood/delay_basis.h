// DelayBasis: an orthonormal basis for the frequency responses of echoes within a window of delays
// on a grid of tones; everything outside the basis is noise.
//
// The left singular vectors of the tone vectors exp(-j 2 pi f tau) / sqrt(tones) for tau in the
// window [-12, 75] ns about the first path. The dimension q follows from the bandwidth: the
// neglected power is below 1e-4 of the total (q = 4 / 6 / 10 at 20 / 40 / 80 MHz).
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"

namespace rayloc {

// Delays 0, step, ... that the search for the first delay of a burst compares.
struct DelaySearch {
  double step = 0.0;  // [s], half of the resolution of the band
  std::size_t count = 0;
};
// All resolvable delays. REQUIRES: grid.size() >= 2.
DelaySearch first_delay_search(const OfdmGrid& grid);

class DelayBasis {
 public:
  // REQUIRES: grid.size() >= 2.
  explicit DelayBasis(const OfdmGrid& grid);

  std::size_t size() const { return size_; }
  // [tone], of unit norm. REQUIRES: coordinate < size().
  std::span<const std::complex<double>> vector(std::size_t coordinate) const {
    const std::size_t tones = angular_offset_.size();
    return std::span(basis_).subspan(coordinate * tones, tones);
  }

  // Coordinates of the unit-norm tone vector with that delay [s]. REQUIRES: out.size() == size().
  void tone(double delay, std::span<std::complex<double>> out) const;

  // out[q] = sum over tones conj(basis[tone][q]) value[tone].
  void project(std::span<const std::complex<double>> value,
               std::span<std::complex<double>> out) const;

  // Covariance of the coordinates of a diffuse tail: a power that sets in at delay 0 and decays
  // exponentially; trace at most 1; row-major [q][q].
  std::vector<std::complex<double>> diffuse_covariance(double decay) const;

 private:
  void exact_tone(double delay, std::span<std::complex<double>> out) const;

  std::vector<double> angular_offset_;  // [rad/s] of each tone
  std::size_t size_ = 0;
  std::vector<std::complex<double>> basis_;  // [q][tone]
  std::vector<std::complex<double>> table_;  // tone() at multiples of kTableStep, [delay][q]
};

}  // namespace rayloc
