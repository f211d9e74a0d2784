#include "engine/baselines/paths/music.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "engine/baselines/paths/turn.h"
#include "engine/baselines/two_pi.h"

namespace rayloc {
namespace {

using std::complex;

// Minimum share of a steering vector's power outside the paths already found; a ratio.
constexpr double kMinRemaining = 1e-3;
constexpr int kNewtonSteps = 4;  // a count: the second already moves it by less than 1e-4 steps
constexpr double kProbe = 0.05;  // of a grid step: for derivatives by differences

}  // namespace

// Remaining signal subspace: orthonormal columns.
struct Music::Subspace {
  Eigen::MatrixXcd found;   // steering vectors of the paths found
  Eigen::MatrixXcd signal;  // signal subspace without them
};

Music::Music(const SmoothingWindow& window, double step_hz, const MusicOptions& options)
    : window_(window),
      step_hz_(step_hz),
      options_(options),
      antenna_(static_cast<Eigen::Index>(options.psi_points), window.antennas),
      tone_(static_cast<Eigen::Index>(options.tau_points), window.tones) {
  for (Eigen::Index i = 0; i < antenna_.rows(); ++i) {
    const double psi =
        kTwoPi * static_cast<double>(i) / static_cast<double>(antenna_.rows()) - std::numbers::pi;
    for (Eigen::Index m = 0; m < window.antennas; ++m) {
      antenna_(i, m) = turn(psi * static_cast<double>(m));
    }
  }
  for (Eigen::Index i = 0; i < tone_.rows(); ++i) {
    const double tau = options_.most_tau *
                       (2.0 * static_cast<double>(i) / static_cast<double>(tone_.rows() - 1) - 1.0);
    for (Eigen::Index l = 0; l < window.tones; ++l) {
      tone_(i, l) = turn(-kTwoPi * tau * step_hz_ * static_cast<double>(l));
    }
  }
}

namespace {

// Power of each steering vector of the grid [psi][tau] in the columns of `basis`.
Eigen::MatrixXd power_in(const Eigen::MatrixXcd& basis,
                         const Eigen::MatrixXcd& antenna,
                         const Eigen::MatrixXcd& tone) {
  Eigen::MatrixXd power = Eigen::MatrixXd::Zero(antenna.rows(), tone.rows());
  for (Eigen::Index column = 0; column < basis.cols(); ++column) {
    Eigen::MatrixXcd sum(antenna.cols(), tone.rows());
    for (Eigen::Index m = 0; m < antenna.cols(); ++m) {
      const auto part = basis.col(column).segment(m * tone.cols(), tone.cols());
      sum.row(m) = (tone * part.conjugate()).transpose();
    }
    power += (antenna * sum).cwiseAbs2();
  }
  return power;
}

Eigen::VectorXcd steering(const SmoothingWindow& window, double psi, double turn_of_tone) {
  Eigen::VectorXcd vector(window.size());
  for (Eigen::Index m = 0; m < window.antennas; ++m) {
    for (Eigen::Index l = 0; l < window.tones; ++l) {
      vector(m * window.tones + l) =
          turn(psi * static_cast<double>(m) + turn_of_tone * static_cast<double>(l));
    }
  }
  return vector;
}

double score_of(const Eigen::MatrixXcd& found,
                const Eigen::MatrixXcd& signal,
                const Eigen::VectorXcd& vector) {
  const double left = vector.squaredNorm() - (found.adjoint() * vector).squaredNorm();
  return left > kMinRemaining * vector.squaredNorm()
             ? (signal.adjoint() * vector).squaredNorm() / left
             : 0.0;
}

}  // namespace

PathAtArray Music::highest(const Subspace& space) const {
  const Eigen::MatrixXd signal = power_in(space.signal, antenna_, tone_);
  const auto whole = static_cast<double>(window_.size());
  const Eigen::MatrixXd left = (whole - power_in(space.found, antenna_, tone_).array()).matrix();
  PathAtArray best;
  best.score = -1.0;
  for (Eigen::Index tau = 0; tau < signal.cols(); ++tau) {
    for (Eigen::Index psi = 0; psi < signal.rows(); ++psi) {
      if (left(psi, tau) > kMinRemaining * whole &&
          signal(psi, tau) / left(psi, tau) > best.score) {
        best = {std::arg(antenna_(psi, 1)),
                options_.most_tau *
                    (2.0 * static_cast<double>(tau) / static_cast<double>(tone_.rows() - 1) - 1.0),
                signal(psi, tau) / left(psi, tau)};
      }
    }
  }
  return best;
}

// Newton steps on the score, restricted to the cell of the grid.
PathAtArray Music::refined(const Subspace& space, PathAtArray path) const {
  const double psi_step = kTwoPi / static_cast<double>(antenna_.rows());
  const double tau_step = 2.0 * options_.most_tau / static_cast<double>(tone_.rows() - 1);
  const auto score = [&](double x, double y) {
    return score_of(
        space.found,
        space.signal,
        steering(window_, path.psi + x * psi_step, -kTwoPi * step_hz_ * (path.tau + y * tau_step)));
  };
  double x = 0.0;
  double y = 0.0;
  double best = score(x, y);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const double h = kProbe;
    const double left = score(x - h, y);
    const double right = score(x + h, y);
    const double below = score(x, y - h);
    const double above = score(x, y + h);
    const double gx = (right - left) / (2.0 * h);
    const double gy = (above - below) / (2.0 * h);
    const double xx = (right - 2.0 * best + left) / (h * h);
    const double yy = (above - 2.0 * best + below) / (h * h);
    const double xy =
        (score(x + h, y + h) - score(x + h, y - h) - score(x - h, y + h) + score(x - h, y - h)) /
        (4.0 * h * h);
    const double determinant = xx * yy - xy * xy;
    if (!(xx < 0.0) || !(determinant > 0.0)) {
      break;
    }
    const double next_x = std::clamp(x - (yy * gx - xy * gy) / determinant, -1.0, 1.0);
    const double next_y = std::clamp(y - (xx * gy - xy * gx) / determinant, -1.0, 1.0);
    const double next = score(next_x, next_y);
    if (!(next > best)) {
      break;
    }
    x = next_x;
    y = next_y;
    best = next;
  }
  return {wrapped(path.psi + x * psi_step), path.tau + y * tau_step, best};
}

std::vector<PathAtArray> Music::paths(const Eigen::MatrixXcd& h) const {
  const Eigen::MatrixXcd snapshots = smoothed_csi(h, window_);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> eigen(snapshots * snapshots.adjoint());
  // Eigen returns them in ascending order.
  const Eigen::VectorXd values = eigen.eigenvalues().reverse().cwiseMax(0.0);
  const std::size_t count =
      std::min(count_paths({values.data(), static_cast<std::size_t>(values.size())},
                           static_cast<std::size_t>(snapshots.cols()),
                           options_.count),
               static_cast<std::size_t>(window_.size() - 1));
  const auto rank = static_cast<Eigen::Index>(count);
  const Eigen::MatrixXcd signal = eigen.eigenvectors().rightCols(rank);
  Subspace space{Eigen::MatrixXcd(window_.size(), 0), signal};
  Eigen::MatrixXcd vectors(window_.size(), 0);
  std::vector<PathAtArray> found;
  for (Eigen::Index i = 0; i < rank; ++i) {
    found.push_back(refined(space, highest(space)));
    vectors.conservativeResize(Eigen::NoChange, i + 1);
    vectors.col(i) = steering(window_, found.back().psi, -kTwoPi * step_hz_ * found.back().tau);
    if (i + 1 == rank) {
      break;
    }
    const Eigen::HouseholderQR<Eigen::MatrixXcd> qr(vectors);
    space.found = qr.householderQ() * Eigen::MatrixXcd::Identity(window_.size(), i + 1);
    const Eigen::MatrixXcd beside = signal - space.found * (space.found.adjoint() * signal);
    const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(beside, Eigen::ComputeThinU);
    space.signal = svd.matrixU().leftCols(rank - i - 1);
  }
  return found;
}

}  // namespace rayloc
