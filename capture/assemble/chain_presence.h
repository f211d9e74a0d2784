// ChainPresence: which of the expected receive chains have brought nothing for so long that no loss
// of datagrams explains it.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc {

class ChainPresence {
 public:
  // Frames in a row without a chain: with a third of all datagrams lost, one in 10^9.
  static constexpr std::uint32_t kFrames = 20;
  // Of a frame that lacks a chain which as many frames before it lacked, too.
  static constexpr std::string_view kFlag = "absent_core";

  // Without an expected core none is ever absent.
  explicit ChainPresence(const std::vector<std::uint8_t>& expected_cores);

  // Flags the frame, and counts it for the cores that it lacks. Frames in the order in which they
  // are emitted.
  void mark(CsiFrame& frame, std::map<std::uint8_t, std::uint64_t>& without_core);

 private:
  std::map<std::uint8_t, std::uint32_t> without_;  // frames in a row, by core
};

}  // namespace rayloc
