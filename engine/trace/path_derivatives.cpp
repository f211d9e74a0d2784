#include "engine/trace/path_derivatives.h"

#include <numbers>

#include "engine/base/check.h"

namespace rayloc {
namespace {

std::complex<double> phasor(double frequency_hz, double tau) {
  return std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz * tau);
}

}  // namespace

std::vector<std::complex<double>> PathDerivatives::cfr(const Paths& paths,
                                                       const OfdmGrid& grid,
                                                       std::size_t parameter) const {
  RAYLOC_CHECK(parameter < parameters_ && paths.size() * parameters_ == values_.size());
  std::vector<std::complex<double>> dh(grid.size());
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const Derivative& d = at(p, parameter);
    const std::complex<double> a{paths[p].a.re, paths[p].a.im};
    for (std::size_t j = 0; j < dh.size(); ++j) {
      const double f = grid.frequency_hz(j);
      const std::complex<double> turn{0.0, -2.0 * std::numbers::pi * f * d.tau};
      dh[j] += (std::complex<double>{d.a.re, d.a.im} + turn * a) * phasor(f, paths[p].tau);
    }
  }
  return dh;
}

std::vector<double> PathDerivatives::loss_gradient(
    const Paths& paths,
    const OfdmGrid& grid,
    std::span<const std::complex<double>> csi_adjoint) const {
  RAYLOC_CHECK(csi_adjoint.size() == grid.size());
  RAYLOC_CHECK(paths.size() * parameters_ == values_.size());
  std::vector<double> gradient(parameters_, 0.0);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    std::complex<double> by_a;  // sum_j conj(g_j) exp(-j 2 pi f_j tau)
    std::complex<double> by_tau;
    for (std::size_t j = 0; j < grid.size(); ++j) {
      const double f = grid.frequency_hz(j);
      const std::complex<double> term = std::conj(csi_adjoint[j]) * phasor(f, paths[p].tau);
      by_a += term;
      by_tau += f * term;
    }
    const std::complex<double> a{paths[p].a.re, paths[p].a.im};
    const double slope = 2.0 * std::numbers::pi * (a * by_tau).imag();
    for (std::size_t i = 0; i < parameters_; ++i) {
      const Derivative& d = at(p, i);
      gradient[i] += by_a.real() * d.a.re - by_a.imag() * d.a.im + slope * d.tau;
    }
  }
  return gradient;
}

}  // namespace rayloc
