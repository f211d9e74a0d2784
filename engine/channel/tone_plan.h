// TonePlan: the tones of an 802.11 frame that carry a channel measurement, and the phase rotation
// that the standard applies to each.
//
// Tone numbers count from the centre of the frame's own bandwidth, in steps of `spacing_hz`; where
// a frame occupies a part of a wider channel, the caller adds the offset of that part. The set for
// HT, VHT and legacy is the standard's, confirmed on recordings; for HE it is the set that the
// published AX-CSI converter keeps (WIRE_FORMATS 1.4), since no recording is public.
//
// References: WIRE_FORMATS 1.4; [11ac] IEEE 802.11-2020 21.3.7.5, equations (21-13) to
// (21-17); [11ax] IEEE 802.11ax-2021 27.3.2.4 (pilots).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc {

struct TonePlan {
  PhyFormat phy = PhyFormat::kLegacy;
  int bandwidth_mhz = 20;
  double spacing_hz = 312'500.0;
  std::vector<std::int16_t> active;  // ascending
  std::vector<std::int16_t> pilots;  // ascending; a subset of `active`
  // Tone active[i] was sent multiplied by j^quarter_turns[i].
  std::vector<std::uint8_t> quarter_turns;
};

// 312.5 kHz, or 78.125 kHz for HE.
double tone_spacing_hz(PhyFormat phy);

// Tones of the transform of that bandwidth, active or not: 64 for VHT 20 MHz, 256 for HE 20 MHz.
int transform_size(PhyFormat phy, int bandwidth_mhz);

// Bandwidths: 20, 40, 80, 160. A legacy frame wider than 20 MHz is the duplicate in every 20 MHz
// part. REQUIRES one of these bandwidths. The plan lives as long as the program.
const TonePlan& tone_plan(PhyFormat phy, int bandwidth_mhz);

}  // namespace rayloc
