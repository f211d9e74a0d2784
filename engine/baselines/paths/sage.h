// Sage: paths of a channel by the SAGE algorithm [SA], on one or several radio channels ("hops")
// jointly, whose tones then form one wide band.
//
// A path with the sine u of its azimuth and the delay tau gives antenna m of hop c, at the tone of
// frequency f, exp(j 2 pi f_c m d u / c) exp(-j 2 pi f tau): f_c is the hop's centre, since a hop
// is narrow. For antenna distances above half a wavelength several u fit one hop alike; several
// hops separate them as far as their wavelengths differ.
//
// Every path is searched for in the residual of the others, over the whole grid, until convergence.
//
// References: [SA] B. Fleury et al., IEEE JSAC 17 (1999) 434.
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/channel/ofdm_grid.h"

namespace rayloc {

struct SagePath {
  double u = 0.0;
  double tau = 0.0;  // [s]
  std::complex<double> amplitude;
};

struct SageOptions {
  std::size_t paths = 5;
  std::size_t u_points = 121;  // from -1 to 1
  double least_tau = -10e-9;   // [s]
  double most_tau = 60e-9;     // [s]
  double tau_step = 0.5e-9;    // [s]
  int rounds = 20;             // at most
};

class Sage {
 public:
  // `hops`: their tones; `spacing` [m] and number of the `antennas`.
  Sage(std::vector<OfdmGrid> hops,
       double spacing,
       std::size_t antennas,
       const SageOptions& options = {});

  // In the order of detection. `h`: of each hop [antenna][tone].
  std::vector<SagePath> paths(std::span<const Eigen::MatrixXcd> h) const;

  // The sum of the paths in hop `hop`: [antenna][tone].
  Eigen::MatrixXcd model(std::span<const SagePath> paths, std::size_t hop) const;

  const std::vector<OfdmGrid>& hops() const { return hops_; }
  std::size_t antennas() const { return antennas_; }
  double spacing() const { return spacing_; }

 private:
  struct Index {
    Eigen::Index u = -1;
    Eigen::Index tau = -1;
    friend bool operator==(const Index&, const Index&) = default;
  };
  SagePath strongest(std::span<const Eigen::MatrixXcd> left, Index& at) const;

  std::vector<OfdmGrid> hops_;
  double spacing_ = 0.0;
  std::size_t antennas_ = 0;
  SageOptions options_;
  double energy_ = 0.0;                    // of a path of amplitude 1
  std::vector<Eigen::MatrixXcd> antenna_;  // of each hop [u][antenna], conjugate steering
  std::vector<Eigen::MatrixXcd> tone_;     // of each hop [tone][tau], conjugate steering
};

}  // namespace rayloc
