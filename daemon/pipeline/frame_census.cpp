#include "daemon/pipeline/frame_census.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "engine/channel/dead_row.h"

namespace rayloc {
namespace {

constexpr double kMemory = 0.01;      // weight of a new frame
constexpr double kDeafestDb = 100.0;  // a chain without any power

double rx_chain_power(const CsiFrame& frame, std::size_t rx_chain) {
  double power = 0.0;
  if (frame.csi.streams() == 0 || is_dead(frame.csi.row(rx_chain, 0))) {
    return power;
  }
  for (std::size_t stream = 0; stream < frame.csi.streams(); ++stream) {
    for (const std::complex<float> h : frame.csi.row(rx_chain, stream)) {
      power += static_cast<double>(std::norm(h));
    }
  }
  return power;
}

}  // namespace

void FrameCensus::add_power(const CsiFrame& frame) {
  std::vector<double> power;
  for (std::size_t i = 0; i < frame.rx_chains.size(); ++i) {
    power.push_back(rx_chain_power(frame, i));
  }
  const double strongest = power.empty() ? 0.0 : *std::max_element(power.begin(), power.end());
  for (std::size_t i = 0; i < frame.rx_chains.size(); ++i) {
    RxChainCensus& rx_chain = rx_chains[frame.rx_chains[i]];
    ++rx_chain.frames;
    if (frame.rx_chains.size() < 2 || !(strongest > 0.0)) {
      continue;
    }
    const double below =
        power[i] > 0.0 ? std::min(kDeafestDb, 10.0 * std::log10(strongest / power[i])) : kDeafestDb;
    const double weight = std::max(kMemory, 1.0 / static_cast<double>(rx_chain.frames));
    rx_chain.below_strongest_db += weight * (below - rx_chain.below_strongest_db);
  }
}

void FrameCensus::add(std::span<const CsiFrame> frames) {
  for (const CsiFrame& frame : frames) {
    format = frame.format;
    ++frames_by_bandwidth_mhz[frame.bandwidth_mhz];
    add_power(frame);
  }
}

}  // namespace rayloc
