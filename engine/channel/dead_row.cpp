#include "engine/channel/dead_row.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rayloc {
namespace {

constexpr std::size_t kFewTones = 8;  // so few may all be equal in a working chain

}  // namespace

bool is_dead(std::span<const std::complex<float>> row) {
  const auto is_finite = [](const std::complex<float>& value) {
    return std::isfinite(value.real()) && std::isfinite(value.imag());
  };
  if (row.empty() || !std::all_of(row.begin(), row.end(), is_finite)) {
    return true;
  }
  // Undoing the 802.11 rotation rotates parts of the channel by quarter turns.
  const std::complex<float> one = row.front();
  const std::complex<float> quarter(-one.imag(), one.real());
  return std::all_of(row.begin(),
                     row.end(),
                     [&](const std::complex<float>& value) {
                       return value == one || value == -one || value == quarter ||
                              value == -quarter;
                     }) &&
         (row.size() >= kFewTones || one == std::complex<float>());
}

bool brings_rx_chain(const CsiFrame& frame, std::uint8_t rx_chain) {
  const auto found = std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chain);
  return found != frame.rx_chains.end() && frame.csi.streams() > 0 &&
         !is_dead(frame.csi.row(static_cast<std::size_t>(found - frame.rx_chains.begin()), 0));
}

}  // namespace rayloc
