#include "engine/observe/chain_gains.h"

#include "engine/base/check.h"

namespace rayloc {

void remove_gains(const ChainGains& gains, std::span<std::complex<double>> h) {
  RAYLOC_CHECK(h.size() == gains.gain.size());
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double power = std::norm(gains.gain[i]);
    h[i] = power > 0.0 ? h[i] * std::conj(gains.gain[i]) / power : 0.0;
  }
}

}  // namespace rayloc
