// FrameCensus: properties of the frames of one source, for a person who sets up an access point
// (chip set, bandwidth, chains with low power).
//
// Thread safety: one thread; a copy may be used in another.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "engine/channel/csi_frame.h"

namespace rayloc {

struct RxChainCensus {
  std::uint64_t frames = 0;  // frames with this chain
  // Mean power of its CSI below that of the strongest chain of the same frame [dB], over about the
  // last 100 frames with two chains or more.
  double below_strongest_db = 0.0;
};

struct FrameCensus {
  std::string format;  // wire format of the last frame; empty before
  std::map<int, std::uint64_t> frames_by_bandwidth_mhz;
  std::map<int, RxChainCensus> rx_chains;

  void add(std::span<const CsiFrame> frames);

 private:
  void add_power(const CsiFrame& frame);
};

}  // namespace rayloc
