// SimulatedRadio: the receiver of an access point during one power cycle: converts the channel at
// its antennas to the CSI reported for a frame.
//
//   H[m,k] = g e^{j (phi + phi_m)} e^{-j 2 pi k df T} G[m,k] sum_n C[m,n] h[n,k] (1 + e[k])
//            + image of the mirrored tone + noise
//
// with G, C and the image's phase drawn once, phi, phi_m, T, g, the transmitter's error e and the
// noise in every frame (METHODS B1). The tones have the phase rotations of 802.11; unused tones
// contain noise and, at DC, garbage.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "capture/decode/csi_decoder.h"
#include "daemon/lab/simulate/impairments.h"
#include "daemon/lab/simulate/random_stream.h"
#include "engine/channel/tone_plan.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {

struct RadioSetup {
  PhyFormat phy = PhyFormat::kVht;
  int bandwidth_mhz = 0;
  double centre_hz = 0.0;
  std::vector<std::uint8_t> rx_chains;
};

// All tones that frames of this radio measure.
OfdmGrid radio_grid(const RadioSetup& setup);

struct RadioFrame {
  // [rx_chain][tone], all tones of the channel from the lowest on.
  std::vector<std::complex<double>> tones;
  std::array<std::int8_t, kMaxRxChains>
      power_dbm{};  // by core; 0: the radio does not have this core
};

class SimulatedRadio {
 public:
  // `calibrated`: the chains used if the impairments require it; may be empty.
  SimulatedRadio(const RadioSetup& setup,
                 const Impairments& impairments,
                 const ChainGains& calibrated,
                 RandomStream random);

  const OfdmGrid& grid() const { return chains_.grid; }
  // True chain gains that a calibration estimates; without coupling and image.
  const ChainGains& chains() const { return chains_; }
  // Applies another power cycle: multiplies each chain by its factor, with ripple, coupling and
  // image unchanged. REQUIRES: none, or one per chain.
  void turn_chains(std::span<const std::complex<double>> factors);
  // Draws phases, offsets, gains and noise of frames from this stream: two radios with the same
  // chains then differ in their frames.
  void draw_frames_from(RandomStream random);

  // `h`: [rx_chain][tone] on grid(), of the field at the antennas. REQUIRES: that size.
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
  std::vector<Value> coupling_;  // [rx_chain][rx_chain]
  std::vector<Value> image_;     // by core
  double noise_power_ = 0.0;     // per tone, in the scale of h
};

}  // namespace rayloc
