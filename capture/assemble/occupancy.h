// Occupancy: which part of the channel a frame fills, and whether with the tones of a legacy frame.
//
// A radio tuned to 80 MHz writes 256 tones for every frame, also for one of 20 MHz; and the
// bandwidth in its rate word is not reliable. The energy is: between filled and empty 20 MHz parts
// there are 25 dB and more, within a filled channel 8 dB at most (WIRE_FORMATS 2: the
// recordings). Of all aligned parts of 20, 40, 80, 160 MHz the one is chosen whose weakest 20 MHz
// stand out most from the strongest outside it and from the guard tones; evenness counts as well,
// because some chips filter the guard tones to far below their noise.
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

// Index on the wire of a tone that counts from the centre of the channel. FFT order; the 512 tones
// of 160 MHz legacy, HT and VHT are two such transforms of 256 tones, the upper half of the band
// first (WIRE_FORMATS 1.4).
std::size_t wire_index(int tone, int total_tones, bool high_efficiency);

// From the slots in `rows`, all of them whole. Without energy, or for a 20 MHz channel: all of it.
Occupancy find_occupancy(const AssembledFrame& frame, std::span<const std::uint8_t> rows);

// Whether the tones that VHT fills and legacy does not are empty: for headers that do not tell.
bool has_legacy_tones(const AssembledFrame& frame,
                      std::span<const std::uint8_t> rows,
                      const Occupancy& occupancy);

}  // namespace rayloc
