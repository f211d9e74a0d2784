// ChainLearner: what the receive chains of every access point of a room multiply by beside what the
// calibration says, learned from devices at places that nobody knows.
//
// After a power cycle chains start at other phases and levels. One burst of one access point then
// looks like another place, about as likely as the right one. Over some bursts the room tells
// (ChainBelief). The states that are probable are then refined (refine_chains()) and compared: a
// level that is off by 2 dB hides the right phases. An access point is believed as calibrated, or
// as learned, until a refined state explains what it heard far better. Then it is left alone until
// one of them explains it far better than all others; it is believed again, with the factors of
// that.
//
// Only bursts that differ from those remembered count, for a device that lies still says the same
// again and again. Times are those of frames: the same frames give the same bytes.
//
// Thread safety: for one thread.
#pragma once

#include <complex>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/chains/chain_belief.h"
#include "engine/chains/chain_refinement.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/observe/alignment.h"

namespace rayloc {

enum class ChainKnowledge {
  kAsCalibrated,
  kLearning,  // they have turned, and nobody knows yet how
  kLearned,
};

// Of one access point of the room.
struct ChainState {
  std::size_t access_point = 0;
  ChainKnowledge knowledge = ChainKnowledge::kAsCalibrated;
  ChainFactors factors;           // that frames are divided by; while learning the last ones
  Timestamp since;                // of this knowledge; the time of a frame, or 0
  std::size_t bursts = 0;         // that counted since then
  std::size_t bursts_needed = 0;  // while learning: in all, as it looks now
};

class ChainLearner {
 public:
  // REQUIRES: learns_from(its likelihood).
  explicit ChainLearner(std::shared_ptr<const Localizer> localizer);
  static bool learns_from(LikelihoodKind kind);
  ~ChainLearner();

  // A burst of one device that is somewhere in the area, as the radios gave it, in order of time.
  void hear(std::span<const CsiFrame> frames);

  // The frames of the access points that are believed, their factors undone.
  std::vector<CsiFrame> believed(std::span<const CsiFrame> frames) const;
  // The same of all access points.
  std::vector<CsiFrame> undone(std::span<const CsiFrame> frames) const;
  // Whether either would change nothing.
  bool leaves_alone() const;

  // By access point, of those of which anything was heard or restored.
  std::vector<ChainState> states() const;
  // What others have found out of an access point takes the place of what was found out here.
  void adopt(const ChainState& state);
  // The same, of before this program began: it outlives restart(). REQUIRES: of this room.
  void restore(const ChainState& state);
  // The access point was off: its chains are probably others.
  void power_cycled(std::size_t access_point, Timestamp time);
  // A recording was moved: what was heard is of another time, what was restored holds again.
  void restart();

 private:
  struct AccessPoint;
  AccessPoint& of(std::size_t access_point);
  void notice_silence(const CsiFrame& frame);
  bool is_due(std::size_t access_point, Timestamp time) const;
  bool is_new(const HeardArray& heard, const AccessPoint& ap) const;
  // Of a burst of which an access point's own part is left out: ln of how likely the device is in
  // every cell, by the access points whose chains are known.
  std::vector<double> by_others(const RoomObservation& observation, std::size_t left_out) const;
  void weigh(const HeardArray& heard,
             std::span<const double> log_weight,
             Timestamp time,
             AccessPoint& ap);
  void decide(const AccessPointMap& map, Timestamp time, AccessPoint& ap);
  std::vector<ChainFactors> compare(const AccessPointMap& map, AccessPoint& ap) const;

  std::shared_ptr<const Localizer> localizer_;
  Aligner aligner_;
  std::map<std::size_t, AccessPoint> aps_;  // by access point of the room
  std::map<std::size_t, ChainState> restored_;
  std::map<std::size_t, Timestamp> heard_;  // the last frame of each access point
};

}  // namespace rayloc
