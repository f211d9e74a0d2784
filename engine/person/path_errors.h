// PathErrors: covariance of the errors of a path past a person. The surfaces before and behind the
// body are the same for all antennas of an array: errors of phase and strength are common to all of
// them, and the direction of arrival is right.
//
//   sum_q g_q g_q^H o K_q
//
// g_q holds the rays of path q at all antennas. They were traced for one place, and their relative
// phases change if the body is at another place in its patch: K_q is their remaining coherence,
// averaged over the places.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/person/person_scattering.h"

namespace rayloc {

class PathErrors {
 public:
  // `numbers`: coordinates of each antenna.
  PathErrors(std::size_t antennas, std::size_t numbers);

  // A ray of an antenna: `field` times the vector s; the share `unknown` of the power has no
  // phase.
  void add(std::size_t antenna,
           const ScatteredRay& ray,
           std::complex<double> field,
           std::span<const std::complex<double>> s,
           double unknown);

  // Lower triangles by rows, of all rays and of the power without phase. `sigma`: deviation of the
  // body's place along x and y [m].
  std::vector<std::complex<double>> all(double sigma) const;
  std::vector<std::complex<double>> without_phase(double sigma) const;

 private:
  using Values = std::vector<std::complex<double>>;

  struct PathSum {
    Values all;      // [antenna][number]
    Values unknown;  // the same
    // For each antenna, the power and its mean phase change with the place [rad/m].
    std::vector<double> power;
    std::vector<double> turn_x;
    std::vector<double> turn_y;
  };

  Values covariance(Values PathSum::*part, double sigma) const;

  std::size_t antennas_;
  std::size_t numbers_;
  std::vector<PathSum> paths_;
};

}  // namespace rayloc
