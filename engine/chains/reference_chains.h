// ReferenceChains: chains with which the array of each link was recorded in the empty room
// (PersonLink::empty, fixed transmitter to access point).
//
// Learned factors are relative to the calibration. An array that was recorded with the chains of
// the calibration is compared with frames whose factors are removed. An array that was recorded
// after a power cycle, on the earlier calibration, contains the factors of that time: frames with
// the learned factors removed match it after multiplication by those. The burst of a fixed
// transmitter distinguishes the two, since a person changes an array less than a phase jump does.
//
// A burst that fits as received has two explanations: the array contains the learned factors, or
// these are from before the start and the chains are as calibrated again. It decides only if the
// state is confirmed (ChainState::is_confirmed). The first clear burst decides, because the array
// does not change. After other factors are learned, the decision is verified with these.
//
// The result depends on the bursts alone. Thread safety: for one thread.
#pragma once

#include <complex>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/chains/chain_state.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/observe/alignment.h"
#include "engine/room/room_model.h"

namespace rayloc {

class ReferenceChains {
 public:
  explicit ReferenceChains(std::shared_ptr<const RoomModel> room);

  // Adds a link. `empty`: [rx_chain][tone], gains of the calibration removed. REQUIRES:
  // calibration_problem() of the access point is empty, and an array of its size.
  void add(const MacAddress& transmitter,
           std::size_t access_point,
           std::vector<std::complex<double>> empty);

  // Evaluates a burst of a transmitter, as received. `states`: of the chains as of this burst.
  void observe(const MacAddress& transmitter,
               std::span<const CsiFrame> frames,
               std::span<const ChainState> states);

  // Factors that the array of the link contains, [chain], to multiply frames by whose learned
  // factors are removed. Empty: those of the calibration, no decision yet, or no such link.
  std::vector<std::complex<double>> recorded(const MacAddress& transmitter,
                                             std::size_t access_point) const;
  // The same; before the decision, what the last clear burst suggests with unconfirmed factors.
  std::vector<std::complex<double>> presumed(const MacAddress& transmitter,
                                             std::size_t access_point) const;
  // True for a link without a decision.
  bool is_undecided(const MacAddress& transmitter, std::size_t access_point) const;

  // Resets to the state before the first burst; links stay.
  void restart();

 private:
  struct Link {
    std::vector<std::complex<double>> empty;
    // Factors in the array, [chain], empty: of the calibration. Nothing: no decision yet.
    std::optional<std::vector<std::complex<double>>> recorded;
    std::vector<std::complex<double>> decided_with;  // learned factors at the decision
    std::vector<std::complex<double>>
        presumed;  // as `recorded`; before the decision, by the last clear burst
  };
  void decide(const ChainState& state, std::span<const CsiFrame> frames, Link& link) const;
  void verify(const ChainState& state, std::span<const CsiFrame> frames, Link& link) const;
  std::optional<double> unexplained(const Link& link,
                                    std::size_t access_point,
                                    std::span<const CsiFrame> frames) const;
  // True if the array contains `factors`, false if it contains none. Nothing if the burst is not
  // clear, or not usable.
  std::optional<bool> contains(const Link& link,
                               const std::vector<std::complex<double>>& factors,
                               const ChainState& state,
                               std::span<const CsiFrame> frames) const;

  std::shared_ptr<const RoomModel> room_;
  Aligner aligner_;
  std::map<std::pair<MacAddress, std::size_t>, Link> links_;
};

}  // namespace rayloc
