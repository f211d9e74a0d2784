// ChainLearner: estimates each receive chain's complex gain relative to the calibration, from
// devices at unknown positions.
//
// After a power cycle the chains start with other phases and amplitudes. One burst of one access
// point then matches a wrong place about as well as the right one. Several bursts together
// determine the state (ChainBelief). The probable states are then refined (refine_chains()) and
// compared: an amplitude error of 2 dB hides the right phases. An access point is accepted as
// calibrated, or as learned, until a refined state explains its bursts far better. It is then left
// out until one state explains its bursts far better than all others; the access point is then
// accepted again, with the factors of that state.
//
// Only bursts that differ from those remembered count, because a device at rest repeats the same
// information. Times are those of frames: the same frames give the same bytes.
//
// Thread safety: for one thread.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/chains/chain_memory.h"
#include "engine/chains/chain_record.h"
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

  // A burst of one device anywhere in the area, as the radios delivered it, in order of time.
  void receive(std::span<const CsiFrame> frames);
  // The same for a transmitter at a known place [m].
  void receive(std::span<const CsiFrame> frames, const Vec3d& place);

  // The frames of the accepted access points, with their factors removed.
  std::vector<CsiFrame> accepted(std::span<const CsiFrame> frames) const;
  // The same for all access points.
  std::vector<CsiFrame> undone(std::span<const CsiFrame> frames) const;
  // Probability that the accepted state is wrong for every access point of accepted frames.
  FrameFault fault_of(std::span<const CsiFrame> accepted) const;
  // True if accepted() and undone() would change nothing.
  bool leaves_alone() const;

  // In order of access points, for those with received frames or a restored state.
  std::vector<ChainState> states() const;
  // Evidence on the chains of an access point that are being learned, for a later run: restore() a
  // state that has it. Empty without evidence.
  std::optional<ChainRecord> record(std::size_t access_point) const;
  // Probability of each state of the chains, [access point of the room][state], before `frames`
  // were received, the last burst with new information on the access point. Empty for other frames:
  // their evidence is in the belief already, and for access points that are not being learned.
  std::vector<std::vector<double>> beliefs_before(std::span<const CsiFrame> frames) const;
  std::uint64_t changes() const { return changes_; }  // equal counts mean equal states
  // Number of times that the last accepted access point was given up: all estimates from frames up
  // to then may have been wrong.
  std::uint64_t withdrawals() const { return withdrawals_; }
  // Replaces the state learned here by one that another learner found for the access point.
  void adopt(const ChainState& state);
  // The same for a state from an earlier run: it outlives restart(). REQUIRES: of this room.
  void restore(const ChainState& state);
  // The access point was powered off: its chains have probably changed.
  void power_cycled(std::size_t access_point, Timestamp time);
  // After a seek in a recording: received bursts are of another time, restored states hold again.
  void restart();

 private:
  struct NewArrays;
  // `last`: time at which an access point was last evaluated for such a transmitter.
  NewArrays new_of(std::span<const CsiFrame> frames, Timestamp ChainMemory::*last);
  void begin();
  ChainMemory& of(std::size_t access_point);
  void notice_silence(const CsiFrame& frame);
  bool is_due(std::size_t access_point, Timestamp time, Timestamp ChainMemory::*last) const;
  // The oldest remembered burst that contains the same information, or null.
  const RememberedBurst* repeated(const ArrayObservation& received, const ChainMemory& ap) const;
  // True if a burst that repeats none is accurate enough, and no waiting one contains the same.
  bool is_new(const ArrayObservation& received, const ChainMemory& ap) const;
  // The arrays of access points with known chains, each with all of its antennas.
  RoomObservation known_of(const RoomObservation& observation) const;
  // By access point with unknown chains, where others are learned from the same burst: its evidence
  // on every cell, averaged over its states.
  using CellsOfEach = std::map<std::size_t, std::vector<double>>;
  CellsOfEach for_any_rotation(const NewArrays& fresh);
  // ln of the probability that the device is in each cell, from the other access points of a burst;
  // the array of access point `left_out` is not used.
  std::vector<double> by_others(const RoomObservation& observation,
                                const CellsOfEach& unknown,
                                std::size_t left_out) const;
  void weigh(const ArrayObservation& received,
             std::span<const double> log_weight,
             Timestamp time,
             ChainMemory& ap);
  void weigh_known(const ArrayObservation& received,
                   const Vec3d& place,
                   Timestamp time,
                   ChainMemory& ap);
  void remember(RememberedBurst burst,
                const ArrayObservation& received,
                Timestamp time,
                ChainMemory& ap);
  void withdraw(Timestamp time, ChainMemory& ap);
  bool are_all_learning() const;
  void decide(const AccessPointMap& map, Timestamp time, ChainMemory& ap);
  void confirm(const ChainFactors& best, double lead, ChainMemory& ap);
  void accept(const ChainFactors& refined, ChainMemory& ap);
  void refine_closely();
  std::vector<ChainFactors> compare(const AccessPointMap& map,
                                    std::span<const RememberedBurst> bursts,
                                    ChainMemory& ap) const;

  std::shared_ptr<const Localizer> localizer_;
  Aligner aligner_;
  CloseBursts close_;
  std::uint64_t changes_ = 0;
  std::uint64_t withdrawals_ = 0;
  std::map<std::size_t, ChainMemory> aps_;  // by access point of the room
  std::map<std::size_t, ChainState> restored_;
  std::map<std::size_t, Timestamp> received_;  // time of the last frame per access point
};

}  // namespace rayloc
