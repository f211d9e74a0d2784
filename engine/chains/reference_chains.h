// ReferenceChains: chains with which the array of each link was recorded in the empty room
// (PersonLink::empty, fixed transmitter to access point).
//
// Learned factors are relative to the calibration. An array that was recorded with the chains of
// the calibration is compared with frames whose factors are removed. An array that was recorded
// after a power cycle, on the earlier calibration, contains the factors: frames with these removed
// do not match it, and frames as received do. The burst of a fixed transmitter distinguishes the
// two, since a person changes an array less than a phase jump does. The first clear burst decides,
// because the array does not change: a later burst that fits as received shows a power cycle back
// to the chains of the calibration.
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

  // True if the array of the link contains the learned factors. False until a burst shows that, and
  // for a link that was not added.
  bool contains_factors(const MacAddress& transmitter, std::size_t access_point) const;

  // Resets to the state before the first burst; links stay.
  void restart();

 private:
  struct Link {
    std::vector<std::complex<double>> empty;
    std::optional<bool> contains_factors;  // nothing: no clear burst yet
  };
  std::optional<double> unexplained(const Link& link,
                                    std::size_t access_point,
                                    std::span<const CsiFrame> frames) const;
  // Nothing if the burst is not clear, or not usable.
  std::optional<bool> evaluate(const Link& link,
                               const ChainState& state,
                               std::span<const CsiFrame> frames) const;

  std::shared_ptr<const RoomModel> room_;
  Aligner aligner_;
  std::map<std::pair<MacAddress, std::size_t>, Link> links_;
};

}  // namespace rayloc
