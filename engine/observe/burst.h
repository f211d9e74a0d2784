// combine_burst: the frames of one transmitter that one access point heard within a few 100 ms,
// made into one array: what a burst without motion really tells.
//
// One frame is H[m,k] = g exp(j phi) exp(-j 2 pi f_k T) G[m,k] h[m,k] + noise, where the gain g,
// the phase phi and the timing offset T are new in every frame and the chain gains G stay for a
// power cycle. Absolute level, phase and delay are therefore lost; every frame is aligned by its
// own (g, phi, T) to the running average and averaged. What remains is G h up to one complex factor
// and one delay. G is not removed here (ChainGains). The level that the receiver states beside its
// CSI (CsiFrame::power_dbm) is kept apart.
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
  // A frame whose normalised correlation with the average is below this is refused: it is another
  // transmitter's, or a broken one.
  double min_correlation = 0.5;
  // Where no frame has all of the cores, the one that most of them lack is left out: its row is
  // zero then (BurstObservation::absent). Otherwise such a burst is refused.
  bool leaves_out_absent = false;
};

// A core of which no frame of a burst brought a measurement.
struct AbsentCore {
  std::size_t row = 0;
  bool is_lasting = false;  // nor did many frames before (capture/assemble/chain_presence.h)
};

struct BurstObservation {
  int access_point = 0;
  MacAddress transmitter;
  Timestamp first;  // of the frames used
  Timestamp last;
  std::size_t frames_used = 0;
  std::size_t frames_unread = 0;               // beyond max_frames: usable as far as we know
  std::map<std::string, std::size_t> refused;  // by reason: "missing_core", "wrong_grid", ...
  OfdmGrid grid;                               // as asked for
  std::vector<std::uint8_t> cores;             // as asked for; the rows of h
  // [core][tone], mean square 1; one common complex factor and one delay are undetermined.
  std::vector<std::complex<double>> h;
  // Variance of one value of h by noise, estimated from the differences between frames. With one
  // frame it is estimated from the differences between neighbouring tones, an upper bound.
  // Without that of `absent`.
  double noise_variance = 0.0;
  double snr_db = 0.0;  // of one frame
  // Level as the receiver states it [dBm]: mean power of the cores asked for, median of the frames
  // used; nothing where no frame states it of all of these cores.
  std::optional<double> level_dbm;
  // What successive frames differ by beyond the noise: the share of the power that is not in the
  // principal component when early and late frames are compared; about 0 without motion.
  double motion_residual = 0.0;
  std::optional<AbsentCore> absent;

  std::complex<double> value(std::size_t core, std::size_t tone) const {
    return h[core * grid.size() + tone];
  }
};

// Reads those of `frames` whose access_point is the one asked for (in the order given, which is
// that of time), all from one transmitter. `cores`: the receive chains wanted, in the order of the
// rows of the result; frames may have more. An Error names why no frame could be used, with counts.
struct BurstRequest {
  int access_point = 0;
  OfdmGrid grid;
  std::vector<std::uint8_t> cores;
  BurstOptions options;
};
Expected<BurstObservation> combine_burst(std::span<const CsiFrame> frames,
                                         const BurstRequest& request);

}  // namespace rayloc
