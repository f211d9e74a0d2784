#include "engine/baselines/paths/sage.h"

#include <cmath>
#include <utility>

#include "engine/base/constants.h"
#include "engine/baselines/paths/turn.h"
#include "engine/baselines/two_pi.h"

namespace rayloc {
namespace {

// Phase from antenna to antenna [rad] for a path with u = 1.
double phase_of(const OfdmGrid& hop, double spacing) {
  return kTwoPi * hop.centre_hz * spacing / kSpeedOfLight;
}

}  // namespace

Sage::Sage(std::vector<OfdmGrid> hops,
           double spacing,
           std::size_t antennas,
           const SageOptions& options)
    : hops_(std::move(hops)), spacing_(spacing), antennas_(antennas), options_(options) {
  const auto u_points = static_cast<Eigen::Index>(options.u_points);
  const auto tau_points = static_cast<Eigen::Index>(
      std::lround((options.most_tau - options.least_tau) / options.tau_step) + 1);
  const auto count = static_cast<Eigen::Index>(antennas);
  for (const OfdmGrid& hop : hops_) {
    Eigen::MatrixXcd& antenna = antenna_.emplace_back(u_points, count);
    for (Eigen::Index i = 0; i < u_points; ++i) {
      const double u = 2.0 * static_cast<double>(i) / static_cast<double>(u_points - 1) - 1.0;
      for (Eigen::Index m = 0; m < count; ++m) {
        antenna(i, m) = turn(-phase_of(hop, spacing) * u * static_cast<double>(m));
      }
    }
    Eigen::MatrixXcd& tone = tone_.emplace_back(static_cast<Eigen::Index>(hop.size()), tau_points);
    for (Eigen::Index k = 0; k < tone.rows(); ++k) {
      const double f = hop.frequency_hz(static_cast<std::size_t>(k));
      for (Eigen::Index i = 0; i < tau_points; ++i) {
        tone(k, i) =
            turn(kTwoPi * f * (options.least_tau + options.tau_step * static_cast<double>(i)));
      }
    }
    energy_ += static_cast<double>(antennas * hop.size());
  }
}

SagePath Sage::strongest(std::span<const Eigen::MatrixXcd> left, Index& at) const {
  Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(antenna_[0].rows(), tone_[0].cols());
  for (std::size_t hop = 0; hop < hops_.size(); ++hop) {
    const Eigen::MatrixXcd of_antennas = left[hop] * tone_[hop];
    sum += antenna_[hop] * of_antennas;
  }
  sum.cwiseAbs2().maxCoeff(&at.u, &at.tau);
  return {2.0 * static_cast<double>(at.u) / static_cast<double>(sum.rows() - 1) - 1.0,
          options_.least_tau + options_.tau_step * static_cast<double>(at.tau),
          sum(at.u, at.tau) / energy_};
}

Eigen::MatrixXcd Sage::model(std::span<const SagePath> paths, std::size_t hop) const {
  const OfdmGrid& grid = hops_[hop];
  Eigen::MatrixXcd h = Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(antennas_),
                                              static_cast<Eigen::Index>(grid.size()));
  for (const SagePath& path : paths) {
    Eigen::VectorXcd antenna(h.rows());
    for (Eigen::Index m = 0; m < h.rows(); ++m) {
      antenna(m) =
          path.amplitude * turn(phase_of(grid, spacing_) * path.u * static_cast<double>(m));
    }
    Eigen::RowVectorXcd tone(h.cols());
    for (Eigen::Index k = 0; k < h.cols(); ++k) {
      tone(k) = turn(-kTwoPi * grid.frequency_hz(static_cast<std::size_t>(k)) * path.tau);
    }
    h += antenna * tone;
  }
  return h;
}

std::vector<SagePath> Sage::paths(std::span<const Eigen::MatrixXcd> h) const {
  std::vector<SagePath> found(options_.paths);
  std::vector<Index> at(options_.paths);
  std::vector<Eigen::MatrixXcd> left(h.begin(), h.end());  // minus all paths
  const auto add = [&](const SagePath& path, double sign) {
    for (std::size_t hop = 0; hop < hops_.size(); ++hop) {
      left[hop] += sign * model({&path, 1}, hop);
    }
  };
  for (int round = 0; round < options_.rounds; ++round) {
    bool moved = false;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (round > 0) {
        add(found[i], 1.0);
      }
      const Index before = at[i];
      found[i] = strongest(left, at[i]);
      add(found[i], -1.0);
      moved = moved || !(before == at[i]);
    }
    if (!moved) {
      break;
    }
  }
  return found;
}

}  // namespace rayloc
