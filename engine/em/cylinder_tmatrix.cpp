#include "engine/em/cylinder_tmatrix.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <Eigen/LU>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Matrix = Eigen::MatrixXcd;
using C = Complex<double>;

// From this absorption on (nepers from the surface to the axis) the wave that has passed is e^-8.
constexpr double kOpaque = 4.0;

std::complex<double> scalar(const C& z) { return {z.re, z.im}; }

// The medium inside for a wave at that elevation.
struct Interior {
  Interior(const C& relative_permittivity, double cos_elevation)
      : permittivity(scalar(relative_permittivity)),
        sin2(1.0 - cos_elevation * cos_elevation),
        wavenumber(sqrt(relative_permittivity - C{sin2, 0.0})),
        ratio(cos_elevation * cos_elevation / scalar(wavenumber * wavenumber)) {}

  std::complex<double> permittivity;
  double sin2;                 // of the elevation
  C wavenumber;                // across the axis, over that of free space
  std::complex<double> ratio;  // squared wavenumber across the axis, outside over inside
};

// Integrals of u d_n w - w d_n u over the boundary, for waves w (rows) and the fields u = (E_z,
// eta_0 H_z) outside that belong to interior fields (columns):
//   d_n E_z = q eps_r d_n E_z inside - sin (1 - q) d_s eta_0 H_z,
//   d_n eta_0 H_z = q d_n eta_0 H_z inside + sin (1 - q) d_s E_z,
// as in cylinder_modes.cpp. Rows and columns of eta_0 H_z are divided by sin, which leaves its
// square.
Matrix radiation(const Interior& interior,
                 const std::array<Family, 2>& waves,
                 const std::array<Family, 2>& fields) {
  const auto& [wv, wh] = waves;
  const auto& [v, h] = fields;
  const Eigen::Index n = v.value.cols();
  const std::complex<double> turn = 1.0 - interior.ratio;
  Matrix q(2 * n, 2 * n);
  q.topLeftCorner(n, n) =
      wv.across.transpose() * v.value -
      (interior.ratio * interior.permittivity) * (wv.value.transpose() * v.across);
  q.topRightCorner(n, n) = (interior.sin2 * turn) * (wv.value.transpose() * h.along);
  q.bottomLeftCorner(n, n) = -turn * (wh.value.transpose() * v.along);
  q.bottomRightCorner(n, n) =
      wh.across.transpose() * h.value - interior.ratio * (wh.value.transpose() * h.across);
  return q;
}

class Solver {
 public:
  Solver(const std::array<double, 2>& axes,
         const C& relative_permittivity,
         double cos_elevation,
         std::size_t count)
      : interior_(relative_permittivity, cos_elevation),
        outside_{cos_elevation, 0.0},
        count_(count),
        opaque_(-interior_.wavenumber.im * std::min(axes[0], axes[1]) > kOpaque),
        quarter_(axes, point_count(axes)),
        sources_(quarter_, cos_elevation, count) {}

  TransitionBlock block(const Symmetry& symmetry) const {
    const std::array<Symmetry, 2> kinds{symmetry, symmetry.across()};
    const auto both = [&](const auto& make) {
      return std::array<Family, 2>{make(kinds[0]), make(kinds[1])};
    };
    const auto fields = both([&](const Symmetry& kind) {
      return opaque_ ? quarter_.entering_waves(interior_.wavenumber, kind, count_)
                     : quarter_.regular_waves(interior_.wavenumber, kind, count_);
    });
    const auto inner = both([&](const Symmetry& kind) { return sources_.waves(kind); });
    const auto regular =
        both([&](const Symmetry& kind) { return quarter_.regular_waves(outside_, kind, count_); });

    const auto n = static_cast<Eigen::Index>(count_);
    Matrix incoming = Matrix::Zero(2 * n, 2 * n);
    incoming.topLeftCorner(n, n) = sources_.incoming(kinds[0]);
    incoming.bottomRightCorner(n, n) = sources_.incoming(kinds[1]);
    const Matrix cancelling = radiation(interior_, inner, fields);
    Matrix radiated = radiation(interior_, regular, fields);
    for (Eigen::Index i = 0; i < 2 * n; ++i) {
      const Symmetry& kind = kinds[i < n ? 0 : 1];
      if (kind.order(static_cast<std::size_t>(i % n)) > 0) {
        radiated.row(i) *= std::numbers::sqrt2;
      }
    }
    // Interior waves of high order are many powers of ten smaller than the others.
    const Eigen::VectorXd scale = cancelling.colwise().norm().cwiseInverse();
    const Matrix fitted = (cancelling * scale.asDiagonal()).partialPivLu().solve(incoming);
    return split(symmetry, -(radiated * scale.asDiagonal()) * fitted);
  }

 private:
  // Enough for products of two of the functions.
  std::size_t point_count(const std::array<double, 2>& axes) const {
    const double inside = opaque_ ? 0.0 : std::sqrt(abs2(interior_.wavenumber));
    return 24 + 2 * count_ + static_cast<std::size_t>((1.0 + inside) * std::abs(axes[0] - axes[1]));
  }

  TransitionBlock split(const Symmetry& symmetry, const Matrix& t) const {
    const auto n = static_cast<Eigen::Index>(count_);
    const Matrix vv = t.topLeftCorner(n, n);
    const Matrix hh = t.bottomRightCorner(n, n);
    TransitionBlock block;
    block.symmetry = symmetry;
    block.vv = 0.5 * (vv + vv.transpose());
    block.hh = 0.5 * (hh + hh.transpose());
    block.vh = t.bottomLeftCorner(n, n).transpose();
    block.asymmetry =
        std::max((vv - block.vv).cwiseAbs().maxCoeff(), (hh - block.hh).cwiseAbs().maxCoeff());
    return block;
  }

  Interior interior_;
  C outside_;  // wavenumber
  std::size_t count_;
  bool opaque_;
  EllipseQuarter quarter_;
  InnerSources sources_;
};

}  // namespace

std::array<TransitionBlock, 4> elliptic_transition(const std::array<double, 2>& k_semi_axes,
                                                   const Complex<double>& relative_permittivity,
                                                   double cos_elevation,
                                                   std::size_t count) {
  RAYLOC_CHECK(cos_elevation > 0.0 && cos_elevation <= 1.0 && count >= 2);
  const Solver solver(k_semi_axes, relative_permittivity, cos_elevation, count);
  std::array<TransitionBlock, 4> blocks;
  std::transform(kSymmetries.begin(), kSymmetries.end(), blocks.begin(), [&](const Symmetry& s) {
    return solver.block(s);
  });
  return blocks;
}

}  // namespace rayloc
