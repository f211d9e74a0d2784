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
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/chains/chain_memory.h"
#include "engine/chains/chain_refinement.h"
#include "engine/chains/chain_state.h"
#include "engine/chains/close_bursts.h"
#include "engine/chains/state_comparison.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/observe/alignment.h"

namespace rayloc {

class ChainLearner {
 public:
  // REQUIRES: learns_from(its likelihood).
  explicit ChainLearner(std::shared_ptr<const Localizer> localizer);
  static bool learns_from(LikelihoodKind kind);
  ~ChainLearner();

  // A burst of one device that is somewhere in the area, as the radios gave it, in order of time.
  void hear(std::span<const CsiFrame> frames);
  // The same of a transmitter whose place is known [m].
  void hear(std::span<const CsiFrame> frames, const Vec3d& place);

  // The frames of the access points that are believed, their factors undone.
  std::vector<CsiFrame> believed(std::span<const CsiFrame> frames) const;
  // The same of all access points.
  std::vector<CsiFrame> undone(std::span<const CsiFrame> frames) const;
  // That none of the access points of believed frames is right to be believed.
  FrameDoubt doubt(std::span<const CsiFrame> believed) const;
  // Whether either would change nothing.
  bool leaves_alone() const;

  // By access point, of those of which anything was heard or restored.
  std::vector<ChainState> states() const;
  std::uint64_t changes() const { return changes_; }  // a count: as long as it stays, they stay
  // How often the last access point that was believed was given up: all that frames said until then
  // may have been wrong.
  std::uint64_t withdrawals() const { return withdrawals_; }
  // What others have found out of an access point takes the place of what was found out here.
  void adopt(const ChainState& state);
  // The same, of before this program began: it outlives restart(). REQUIRES: of this room.
  void restore(const ChainState& state);
  // The access point was off: its chains are probably others.
  void power_cycled(std::size_t access_point, Timestamp time);
  // A recording was moved: what was heard is of another time, what was restored holds again.
  void restart();

 private:
  struct Told;
  // `last`: when an access point was looked at for such a transmitter.
  Told new_of(std::span<const CsiFrame> frames, Timestamp ChainMemory::*last);
  void begin();
  ChainMemory& of(std::size_t access_point);
  void notice_silence(const CsiFrame& frame);
  bool is_due(std::size_t access_point, Timestamp time, Timestamp ChainMemory::*last) const;
  bool is_new(const HeardArray& heard, const ChainMemory& ap) const;
  // Of the arrays those of access points whose chains are known, all antennas of each.
  RoomObservation known_of(const RoomObservation& observation) const;
  // By access point whose chains nobody knows, where others are learned from the same burst: what
  // it says of every cell all the same.
  using CellsOfEach = std::map<std::size_t, std::vector<double>>;
  CellsOfEach whatever_turned(const Told& told);
  // Of a burst of which an access point's own part is left out: ln of how likely the device is in
  // every cell, by the other access points.
  std::vector<double> by_others(const RoomObservation& observation,
                                const CellsOfEach& unknown,
                                std::size_t left_out) const;
  void weigh(const HeardArray& heard,
             std::span<const double> log_weight,
             Timestamp time,
             ChainMemory& ap);
  void weigh_known(const HeardArray& heard, const Vec3d& place, Timestamp time, ChainMemory& ap);
  void remember(RememberedBurst burst, const HeardArray& heard, Timestamp time, ChainMemory& ap);
  void withdraw(Timestamp time, ChainMemory& ap);
  bool believes_nobody() const;
  void decide(const AccessPointMap& map, Timestamp time, ChainMemory& ap);
  void believe(const ChainFactors& refined, ChainMemory& ap);
  void refine_closely();
  std::vector<ChainFactors> compare(const AccessPointMap& map, ChainMemory& ap) const;

  std::shared_ptr<const Localizer> localizer_;
  Aligner aligner_;
  CloseBursts close_;
  std::uint64_t changes_ = 0;
  std::uint64_t withdrawals_ = 0;
  std::map<std::size_t, ChainMemory> aps_;  // by access point of the room
  std::map<std::size_t, ChainState> restored_;
  std::map<std::size_t, Timestamp> heard_;  // the last frame of each access point
};

}  // namespace rayloc
