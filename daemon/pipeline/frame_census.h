// FrameCensus: what the frames of one source have been like: what somebody who sets up an access
// point wants to know (chip set, bandwidth, chains that are deaf).
//
// Thread safety: one thread; a copy may go elsewhere.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "engine/channel/csi_frame.h"

namespace rayloc {

struct CoreCensus {
  std::uint64_t frames = 0;  // with this core
  // Mean power of its CSI below that of the strongest core of the same frame [dB], over about the
  // last 100 frames of two cores or more.
  double below_strongest_db = 0.0;
};

struct FrameCensus {
  std::string format;  // wire format of the last frame; empty before
  std::map<int, std::uint64_t> frames_by_bandwidth_mhz;
  std::map<int, CoreCensus> cores;

  void add(std::span<const CsiFrame> frames);

 private:
  void add_power(const CsiFrame& frame);
};

}  // namespace rayloc
