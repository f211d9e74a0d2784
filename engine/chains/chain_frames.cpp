#include "engine/chains/chain_frames.h"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "engine/chains/state_comparison.h"

namespace rayloc {
namespace {

constexpr auto kMoment = std::chrono::milliseconds(30);  // as in DeviceTracker

}  // namespace

void multiply(const RoomAccessPoint& ap,
              const std::vector<std::complex<double>>& factors,
              CsiFrame& frame) {
  for (std::size_t row = 0; row < frame.rx_chains.size(); ++row) {
    const auto rx_chain = std::find(ap.rx_chains.begin(), ap.rx_chains.end(), frame.rx_chains[row]);
    if (rx_chain == ap.rx_chains.end()) {
      continue;
    }
    const std::complex<float> factor(
        factors[static_cast<std::size_t>(rx_chain - ap.rx_chains.begin())]);
    for (std::size_t stream = 0; stream < frame.csi.streams(); ++stream) {
      for (std::complex<float>& value : frame.csi.row(row, stream)) {
        value *= factor;
      }
    }
  }
}

void undo(const ChainState& state, const RoomAccessPoint& ap, std::span<CsiFrame> frames) {
  const std::vector<std::complex<double>> undoing = inverses(state.factors.factor);
  for (CsiFrame& frame : frames) {
    if (frame.access_point == state.access_point) {
      multiply(ap, undoing, frame);
    }
  }
}

std::span<const CsiFrame> first_moment(std::span<const CsiFrame> frames) {
  const auto end = std::find_if(frames.begin(), frames.end(), [&](const CsiFrame& frame) {
    return frame.time - frames.front().time > kMoment;
  });
  return frames.first(static_cast<std::size_t>(end - frames.begin()));
}

}  // namespace rayloc
