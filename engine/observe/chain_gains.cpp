#include "engine/observe/chain_gains.h"

#include <Eigen/LU>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Matrix = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const Matrix> coupling_of(const ChainGains& gains) {
  const auto rx_chains = static_cast<Eigen::Index>(gains.rx_chains.size());
  RAYLOC_CHECK(gains.coupling.size() == static_cast<std::size_t>(rx_chains * rx_chains));
  return {gains.coupling.data(), rx_chains, rx_chains};
}

Eigen::Map<Matrix> rows_of(const ChainGains& gains, std::span<std::complex<double>> h) {
  const auto rx_chains = static_cast<Eigen::Index>(gains.rx_chains.size());
  return {h.data(), rx_chains, static_cast<Eigen::Index>(h.size()) / rx_chains};
}

}  // namespace

void apply_coupling(const ChainGains& gains, std::span<std::complex<double>> h) {
  if (!gains.coupling.empty()) {
    auto rows = rows_of(gains, h);
    rows = (coupling_of(gains) * rows).eval();
  }
}

void remove_gains(const ChainGains& gains, std::span<std::complex<double>> h) {
  RAYLOC_CHECK(h.size() == gains.gain.size());
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double power = std::norm(gains.gain[i]);
    h[i] = power > 0.0 ? h[i] * std::conj(gains.gain[i]) / power : 0.0;
  }
  if (!gains.coupling.empty()) {
    auto rows = rows_of(gains, h);
    rows = coupling_of(gains).partialPivLu().solve(rows).eval();
  }
}

}  // namespace rayloc
