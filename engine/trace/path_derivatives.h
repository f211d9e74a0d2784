// PathDerivatives: derivatives of every path of a link by every parameter, and the gradient of a
// loss of the channel.
//
// Forward mode along a path (dual numbers), reverse mode across the tones: with dL/dh given for
// all tones, one pass over paths and tones gives dL/da and dL/dtau of every path, for any
// number of parameters.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/complex.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/trace/paths.h"

namespace rayloc {

class PathDerivatives {
 public:
  struct Derivative {
    Complex<double> a;  // d Path::a, per unit of the parameter
    double tau = 0.0;   // d Path::tau [s]
  };

  PathDerivatives() = default;
  PathDerivatives(std::size_t paths, std::size_t parameters)
      : parameters_(parameters), values_(paths * parameters) {}

  std::size_t parameter_count() const { return parameters_; }
  Derivative& at(std::size_t path, std::size_t parameter) {
    return values_[path * parameters_ + parameter];
  }
  const Derivative& at(std::size_t path, std::size_t parameter) const {
    return values_[path * parameters_ + parameter];
  }

  // dh_j / d parameter for every tone of the grid.
  std::vector<std::complex<double>> cfr(const Paths& paths,
                                        const OfdmGrid& grid,
                                        std::size_t parameter) const;

  // Derivatives of a real loss L of the channel by every parameter. `csi_adjoint`: g_j with dL
  // = Re sum_j conj(g_j) dh_j, so for L = sum |h_j|^2 it is 2 h_j. REQUIRES:
  // csi_adjoint.size() == grid.size().
  std::vector<double> loss_gradient(const Paths& paths,
                                    const OfdmGrid& grid,
                                    std::span<const std::complex<double>> csi_adjoint) const;

 private:
  std::size_t parameters_ = 0;
  std::vector<Derivative> values_;
};

}  // namespace rayloc
