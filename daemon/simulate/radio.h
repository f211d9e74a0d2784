// SimulatedRadio: the receiver of an access point for the time of one power cycle: from the channel
// at its antennas to the CSI that it reports of a frame.
//
//   H[m,k] = g e^{j (phi + phi_m)} e^{-j 2 pi k df T} G[m,k] sum_n C[m,n] h[n,k] (1 + e[k])
//            + image of the mirrored tone + noise
//
// with G, C and the image's phase drawn once, phi, phi_m, T, g, the transmitter's error e and the
// noise in every frame (METHODS B1). The tones are turned as 802.11 turns them on the air; between
// them stand noise and, at DC, garbage.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "capture/decode/csi_decoder.h"
#include "daemon/simulate/impairments.h"
#include "daemon/simulate/random_stream.h"
#include "engine/channel/tone_plan.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {

struct RadioSetup {
  PhyFormat phy = PhyFormat::kVht;
  int bandwidth_mhz = 0;
  double centre_hz = 0.0;
  std::vector<std::uint8_t> cores;
};

// All tones that frames of this radio measure.
OfdmGrid radio_grid(const RadioSetup& setup);

struct RadioFrame {
  // [core][tone], all tones of the channel from the lowest on.
  std::vector<std::complex<double>> tones;
  std::array<std::int8_t, kMaxCores> power_dbm{};  // by core; 0: not one of the radio's
};

class SimulatedRadio {
 public:
  // `calibrated`: the chains to have if the impairments say so; may be empty.
  SimulatedRadio(const RadioSetup& setup,
                 const Impairments& impairments,
                 const ChainGains& calibrated,
                 RandomStream random);

  const OfdmGrid& grid() const { return chains_.grid; }
  // The truth that a calibration looks for; coupling and image apart.
  const ChainGains& chains() const { return chains_; }
  // What another power cycle leaves: each chain times its factor, ripple, coupling and image as
  // they were. REQUIRES: none, or one of each chain.
  void turn_chains(std::span<const std::complex<double>> factors);
  // Phases, offsets, levels and noise of frames come from here on: those of two radios with the
  // same chains are not the same.
  void draw_frames_from(RandomStream random);

  // `h`: [core][tone] on grid(), of the field at the antennas. REQUIRES: that size.
  RadioFrame receive(std::span<const std::complex<double>> h, std::uint64_t transmit_error_seed);

 private:
  using Value = std::complex<double>;

  void draw_chains(const ChainGains& calibrated);
  void draw_coupling(const ChainGains& calibrated);
  Value normal();  // complex, of unit power
  std::vector<Value> transmit_error(std::uint64_t seed) const;
  std::vector<Value> at_chains(std::span<const Value> h, std::uint64_t error_seed) const;
  void turn(std::vector<Value>& signal);
  void add_image(std::vector<Value>& signal) const;
  RadioFrame on_channel(const std::vector<Value>& signal);
  void set_level(RadioFrame& frame);

  RadioSetup setup_;
  Impairments impairments_;
  RandomStream random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  ChainGains chains_;
  std::vector<Value> coupling_;  // [core][core]
  std::vector<Value> image_;     // of each core
  double noise_power_ = 0.0;     // of a tone, in the scale of h
};

}  // namespace rayloc
