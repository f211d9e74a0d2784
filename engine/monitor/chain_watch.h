// ChainWatch: whether receive chains have turned since the calibration, from devices at places that
// nobody knows.
//
// After a power cycle a chip's chains start in other states, quarter turns apart. One burst of one
// access point then looks like another place, about as likely as the right one. Over some bursts
// the room tells: with Z_0 the mean over the room of the (tempered) likelihood of what was heard,
// and Z_v that of the same with its chains turned by quarters, ln Z_v - ln Z_0 adds up from burst
// to burst, with the prior that a chain has turned. Only bursts that differ from those that counted
// before count, for a device that lies still says the same again and again.
//
// It looks at few bursts, because each costs some ten times a fix: one a second while something may
// be wrong, one in ten seconds else, by the time of the frames. Each access point is looked at by
// itself, however many hear the burst: the others outvote one whose chains have turned where they
// know the place well (access_point_fusion.h), and beside it where they do not.
//
// Thread safety: none; the owner's thread alone.
#pragma once

#include <complex>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/observe/alignment.h"

namespace rayloc {

class ChainWatch {
 public:
  static constexpr double kSure = 0.9999;  // from which on chains count as turned

  explicit ChainWatch(std::shared_ptr<const Localizer> localizer);

  // A burst of one device that is somewhere in the area, in order of time.
  void hear(std::span<const CsiFrame> frames);

  // As before the first burst.
  void restart() { aps_.clear(); }

  // An access point whose chains are turned, more probably than kSure, until later bursts say
  // otherwise.
  struct Turn {
    std::size_t access_point = 0;  // of the room
    std::vector<double> phase;     // [rad] of each core, the first 0: how far they have turned
    double probability = 0.0;
    std::size_t bursts = 0;  // that counted
  };
  std::vector<Turn> turned() const;
  // The frames of all other access points.
  static std::vector<CsiFrame> believed(std::span<const CsiFrame> frames,
                                        std::span<const Turn> turned);

 private:
  using Array = std::vector<std::complex<double>>;
  struct AccessPoint {
    std::vector<double> log_odds;  // of each state against that of the calibration
    std::vector<Array> heard;      // bursts that counted last
    std::size_t next = 0;          // of them to be forgotten
    std::size_t bursts = 0;
    Timestamp last;  // looked at

    double probability() const;
    bool is_settled() const;
  };

  bool is_due(std::size_t access_point, Timestamp time) const;
  bool is_new(const AccessPoint& ap, const Array& h) const;
  double log_evidence(const HeardArray& heard) const;
  void weigh(const HeardArray& heard, AccessPoint& ap) const;

  std::shared_ptr<const Localizer> localizer_;
  Aligner aligner_;
  std::map<std::size_t, AccessPoint> aps_;  // by access point of the room
};

}  // namespace rayloc
