// Occupancy: the part of the channel that a frame fills, and whether it has a legacy frame's tones.
//
// A radio tuned to 80 MHz writes 256 tones for every frame, also for one of 20 MHz, and the
// bandwidth in its rate word is not reliable. The energy is reliable: filled and empty 20 MHz parts
// differ by 25 dB and more, parts of a filled channel by 8 dB at most (WIRE_FORMATS 2: the
// recordings). The chosen hypothesis is the aligned part of 20, 40, 80, 160 MHz whose weakest 20
// MHz exceed the strongest outside it and the guard tones by most; evenness counts as well, because
// some chips filter the guard tones to far below their noise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "capture/assemble/frame_assembler.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

struct Occupancy {
  int bandwidth_mhz = 20;
  // Centre of the occupied part, in tones from the centre of the channel.
  int centre_tone = 0;

  friend bool operator==(const Occupancy&, const Occupancy&) = default;
};

// Index on the wire of a tone counted from the centre of the channel. FFT order; the 512 tones of
// 160 MHz legacy, HT and VHT are two such transforms of 256 tones, the upper half of the band first
// (WIRE_FORMATS 1.4).
std::size_t wire_index(int tone, int total_tones, bool high_efficiency);

// Computed from the slots in `rows`, all of them whole. Without energy, or at 20 MHz: all of it.
Occupancy find_occupancy(const AssembledFrame& frame, std::span<const std::uint8_t> rows);

// True if the tones that VHT fills and legacy does not are empty: for headers without a format.
bool has_legacy_tones(const AssembledFrame& frame,
                      std::span<const std::uint8_t> rows,
                      const Occupancy& occupancy);

}  // namespace rayloc
