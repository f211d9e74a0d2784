// Intel5300Decoder: the records of the log that the Linux 802.11n CSI tool writes for an Intel WiFi
// Link 5300 [HH]; one record is a whole frame. In files they come from PcapParser (.dat logs).
//
// The card reports 30 tones of a 20 or 40 MHz HT frame, and the antenna to which each of its
// receive chains was switched. Its values have the engine's sign; at 40 MHz they include the
// rotation of the upper half, which is undone here (WIRE_FORMATS 1.9).
//
// References: [HH] D. Halperin et al., ACM SIGCOMM CCR 41 (2011) 53; the tool's documentation.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "capture/decode/frame_decoder.h"

namespace rayloc {

class Intel5300Decoder final : public FrameDecoder {
 public:
  std::string_view format() const override { return "intel-5300"; }
  FrameResult decode(std::span<const std::byte> payload) const override;
};

}  // namespace rayloc
