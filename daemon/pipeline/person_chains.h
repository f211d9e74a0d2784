// PersonChains: the frames of fixed transmitters with the receive chains of their reference, for
// locating people.
//
// A person is located by the change of a link relative to the empty room. After a power cycle the
// frames of the access point contain the new factors of its chains, and the array of the empty room
// does not: learned factors are removed. Access points whose chains are being learned are left out.
// The chains of a transmitter have no effect, because it has one antenna.
//
// Where the empty room was recorded after a power cycle, on the earlier calibration, the array
// contains the factors of that time (ReferenceChains): the frames are multiplied by these, with a
// warning. Frames of access points whose chains the calibration does not state are used as
// received.
//
// The result depends on the bursts alone. Thread safety: for one thread, except notices(), for
// one other thread.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "engine/chains/chain_state.h"
#include "engine/chains/reference_chains.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

class PersonChains {
 public:
  // `file`: of chains learned before, for bursts that come without a state; empty: none.
  PersonChains(const std::string& file, std::shared_ptr<const RoomModel> room);

  // Adds the links of a transmitter, except those that check_link() refuses. To be called before
  // its first burst.
  void add(const PersonReference& reference);

  // The usable frames of a burst.
  struct Usable {
    std::span<const CsiFrame> frames;  // of the burst or of `kept`
    std::vector<CsiFrame> kept;
    std::vector<std::string> warnings;
    // Reason why no access point of the reference can be used; empty: no such reason.
    std::string reason;
  };
  // `states`: of the chains as of the burst; null: those of the file.
  Usable usable(const Burst& burst, const std::vector<ChainState>* states);

  // A recording continues at another position.
  void restart() { references_.restart(); }

  // Lines for the log about the file, at the first call.
  std::vector<std::string> notices() { return std::exchange(notices_, {}); }

 private:
  void apply(const ChainState& state,
             const MacAddress& transmitter,
             bool is_of_file,
             Usable& result) const;
  void leave_out(const ChainState& state, bool is_of_file, Usable& result) const;
  std::string unlearned_text() const;
  bool has_link(const MacAddress& transmitter, std::span<const CsiFrame> frames) const;

  std::shared_ptr<const RoomModel> room_;
  std::string file_;
  std::vector<std::string> notices_;
  std::vector<ChainState> restored_;
  ReferenceChains references_;
  std::map<MacAddress, std::set<std::size_t>> access_points_;  // of the links of each transmitter
};

}  // namespace rayloc
