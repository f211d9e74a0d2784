// ChainPresence: detects expected receive chains that have been absent from more consecutive frames
// than datagram loss explains.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc {

class ChainPresence {
 public:
  // Consecutive frames without a chain; with a third of all datagrams lost, probability 10^-9.
  static constexpr std::uint32_t kFrames = 20;
  // Flag of a frame that lacks a chain which at least as many frames before it lacked as well.
  static constexpr std::string_view kFlag = "absent_core";

  // With no expected cores, no chain is ever reported as absent.
  explicit ChainPresence(const std::vector<std::uint8_t>& expected_rx_chains);

  // Flags the frame and counts it for each core that it lacks. REQUIRES: frames come in the order
  // in which they are emitted.
  void mark(CsiFrame& frame, std::map<std::uint8_t, std::uint64_t>& without_rx_chain);

 private:
  std::map<std::uint8_t, std::uint32_t> without_;  // consecutive frames without the core, by core
};

}  // namespace rayloc
