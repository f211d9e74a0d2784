#include "engine/trace/path_derivatives.h"

#include <numbers>

#include "engine/base/check.h"
#include "engine/trace/cfr_kernel.h"

namespace rayloc {
namespace {

struct Columns {
  explicit Columns(const Paths& paths) {
    a_re.reserve(paths.size());
    a_im.reserve(paths.size());
    tau.reserve(paths.size());
    for (const Path& path : paths) {
      a_re.push_back(path.a.re);
      a_im.push_back(path.a.im);
      tau.push_back(path.tau);
    }
  }
  PathArrays arrays() const { return {a_re, a_im, tau}; }

  std::vector<double> a_re;
  std::vector<double> a_im;
  std::vector<double> tau;
};

}  // namespace

std::vector<std::complex<double>> PathDerivatives::cfr(const Paths& paths,
                                                       const OfdmGrid& grid,
                                                       std::size_t parameter) const {
  RAYLOC_CHECK(parameter < parameters_ && paths.size() * parameters_ == values_.size());
  // dh_j = sum (da - j 2 pi f_j a dtau) exp(-j 2 pi f_j tau): two channels, one of them times f_j.
  Columns by_a(paths);
  Columns by_tau(paths);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const Derivative& d = at(p, parameter);
    const double slope = 2.0 * std::numbers::pi * d.tau;
    by_tau.a_re[p] = slope * paths[p].a.im;
    by_tau.a_im[p] = -slope * paths[p].a.re;
    by_a.a_re[p] = d.a.re;
    by_a.a_im[p] = d.a.im;
  }
  const CfrKernel kernel(grid);
  std::vector<std::complex<double>> dh(grid.size());
  std::vector<std::complex<double>> times_f(grid.size());
  kernel.forward(by_a.arrays(), dh);
  kernel.forward(by_tau.arrays(), times_f);
  for (std::size_t j = 0; j < dh.size(); ++j) {
    dh[j] += grid.frequency_hz(j) * times_f[j];
  }
  return dh;
}

std::vector<double> PathDerivatives::loss_gradient(
    const Paths& paths,
    const OfdmGrid& grid,
    std::span<const std::complex<double>> csi_adjoint) const {
  RAYLOC_CHECK(csi_adjoint.size() == grid.size());
  RAYLOC_CHECK(paths.size() * parameters_ == values_.size());
  const PathAdjoints adjoint = CfrKernel(grid).adjoint(Columns(paths).arrays(), csi_adjoint);
  std::vector<double> gradient(parameters_, 0.0);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    for (std::size_t i = 0; i < parameters_; ++i) {
      const Derivative& d = at(p, i);
      gradient[i] += adjoint.a_re[p] * d.a.re + adjoint.a_im[p] * d.a.im + adjoint.tau[p] * d.tau;
    }
  }
  return gradient;
}

}  // namespace rayloc
