// combine_burst: combines the frames of one transmitter that one access point received within a few
// 100 ms into one array: the information of a burst without motion.
//
// One frame is H[m,k] = g exp(j phi) exp(-j 2 pi f_k T) G[m,k] h[m,k] + noise, where the gain g,
// the phase phi and the timing offset T are new in every frame and the chain gains G are constant
// for a power cycle. Absolute power, phase and delay are therefore lost; every frame is aligned by
// its own (g, phi, T) to the running average and averaged. The result is G h up to one complex
// factor and one delay. G is not removed here (ChainGains). The power that the receiver reports
// beside its CSI (CsiFrame::power_dbm) is kept separately.
//
// The cost is bounded: at most BurstOptions::max_frames frames are read, spread evenly over the
// burst; the others are only counted.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/channel/ofdm_grid.h"

namespace rayloc {

struct BurstOptions {
  std::size_t max_frames = 32;
  // A frame is refused when its normalised correlation with the average is below this: it comes
  // from another transmitter, or it is corrupt.
  double min_correlation = 0.5;
  // Where no frame has all of the cores, the core that most frames lack is left out: its row is
  // then zero (BurstObservation::absent). Otherwise such a burst is refused.
  bool leaves_out_absent = false;
  // A single frame is aligned to itself, which changes it by rounding and takes most of the time.
  bool aligns_single_frame = true;
};

// A core that is missing from every frame of a burst.
struct AbsentRxChain {
  std::size_t row = 0;
  bool is_lasting = false;  // missing for long (capture/assemble/chain_presence.h)
};

struct BurstObservation {
  std::size_t access_point = 0;
  MacAddress transmitter;
  Timestamp first;  // of the frames used
  Timestamp last;
  std::size_t frames_used = 0;
  std::size_t frames_unread = 0;               // beyond max_frames, not checked
  std::map<std::string, std::size_t> refused;  // by reason: "missing_core", "wrong_grid", ...
  OfdmGrid grid;                               // as requested
  std::vector<std::uint8_t> rx_chains;         // as requested; the rows of h
  // [rx_chain][tone], mean square 1; one common complex factor and one delay are undetermined.
  std::vector<std::complex<double>> h;
  // Noise variance of one value of h, estimated from the differences between frames. With one
  // frame it is estimated from the differences between neighbouring tones, an upper bound. It
  // excludes `absent`.
  double noise_variance = 0.0;
  double snr_db = 0.0;  // of one frame
  // Power as the receiver reports it [dBm]: mean power of the requested cores, median of the frames
  // used; nothing where no frame states it for all of these cores.
  std::optional<double> power_dbm;
  // Difference between successive frames beyond the noise: the share of the power that is not in
  // the principal component when early and late frames are compared; about 0 without motion.
  double motion_residual = 0.0;
  std::optional<AbsentRxChain> absent;

  std::complex<double> value(std::size_t rx_chain, std::size_t tone) const {
    return h[rx_chain * grid.size() + tone];
  }
};

// Reads the `frames` of the requested access_point, all from one transmitter, in the given order,
// which is that of time. `rx_chains`: the receive chains wanted, in the order of the result's rows;
// frames may have more. An Error states why no frame could be used, with counts.
struct BurstRequest {
  std::size_t access_point = 0;
  OfdmGrid grid;
  std::vector<std::uint8_t> rx_chains;
  BurstOptions options;
};
Expected<BurstObservation> combine_burst(std::span<const CsiFrame> frames,
                                         const BurstRequest& request);

}  // namespace rayloc
