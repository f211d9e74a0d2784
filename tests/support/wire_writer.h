// Writes datagrams in the formats of the extractors, for cases without a public recording: HE, HT,
// 160 MHz, several datagrams per core, several streams. Written only from the tables of
// WIRE_FORMATS 1; shares no code with the decoders.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/support/recording.h"

namespace rayloc::test {

enum class WirePhy { kLegacy = 0, kHt = 1, kVht = 2, kHe = 3 };

// The channel of one receive chain and stream at a tone, counted from the channel's centre.
using WireChannel = std::function<std::complex<double>(int rx_chain, int stream, int tone)>;

// One path of unit size with a delay [s]: exp(-j 2 pi f tau), f from the centre of the channel;
// chains and streams differ by a phase.
WireChannel delayed_path(double delay, double spacing_hz);

struct WireFrame {
  WirePhy phy = WirePhy::kVht;
  int channel_mhz = 40;
  // Occupied bandwidth of the frame, and its centre in tones from the channel's centre.
  int occupied_mhz = 40;
  int centre_tone = 0;
  int training_stride = 1;  // HE: 2 and 4 sound only every second or fourth tone
  std::vector<int> rx_chains = {0, 1, 2, 3};
  int streams = 1;  // number of extracted streams
  int transmitted_streams = 1;
  std::uint64_t transmitter = 0x02524c000001;
  std::uint16_t sequence = 1;
  std::uint16_t sequence_control = 0x10;
  // Broadcom's; 0: the channel of that width which contains channel 36, at 40 MHz 5190 MHz.
  std::uint16_t chanspec = 0;
  std::vector<int> power_dbm = {-41, -42, -43, -44};
  WireChannel channel = delayed_path(100e-9, 312'500.0);
  // Value of the tones without a signal: 0 at most of them, this at the centre.
  std::complex<double> garbage_at_centre = {3.0, -2.0};
};

// In the formats of bcm43684 and bcm4366c0, of bcm4358, and as two int16. Rounded to the nearest
// value with the largest mantissa.
std::uint32_t pack_float12(std::complex<double> value);
std::uint32_t pack_float9(std::complex<double> value);
std::uint32_t pack_int16(std::complex<double> value);

// The tones of one core and stream in wire order, with the rotations of 802.11.
std::vector<std::complex<double>> wire_tones(const WireFrame& frame, int rx_chain, int stream);

// The frame's datagrams, all of the same time: for each core, for each stream, for each 256 tones.
Recording write_axcsi(const WireFrame& frame, Timestamp time);

enum class NexmonChip { k4339 = 0x0001, k4358 = 0x0003, k43455c0 = 0x0065, k4366c0 = 0x006a };
Recording write_nexmon(const WireFrame& frame, NexmonChip chip, int version, Timestamp time);

Recording write_ubilocate(const WireFrame& frame, Timestamp time);

}  // namespace rayloc::test
