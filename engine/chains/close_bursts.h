// CloseBursts: bursts at the places where they may be from, centimetres apart, as all access points
// whose chains are known heard them.
//
// A burst stands for a sample of the places where it may be from (sample_places()), drawn as chains
// were believed to be then. Where that has changed, it is drawn again.
//
// A cell of the grid is wider than a wavelength: what it says of a phase is smeared, and the state
// that its mean asks for is some degrees beside the right one. Once the chains are known roughly,
// the places within the cells are told apart, and what several access points hear of one place
// tells the phases of each.
#pragma once

#include <complex>
#include <cstddef>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "engine/chains/chain_refinement.h"
#include "engine/localize/localizer.h"

namespace rayloc {

class CloseBursts {
 public:
  explicit CloseBursts(double likelihood_exponent) : likelihood_exponent_(likelihood_exponent) {}

  // `observation`: by access points whose chains are known, all of their antennas. A burst that no
  // place explains is left out; the oldest makes room.
  void add(const Localizer& localizer, const RoomObservation& observation);

  // What is believed of an access point of the room has changed by these factors, [chain].
  void believe(std::size_t access_point, std::span<const std::complex<double>> factor);
  void clear();

  // Whether enough bursts have come since this was asked last for the factors to become better.
  bool is_due();
  // Whether enough of them are of the access point.
  bool tells_of(std::size_t access_point) const;
  // Its factors against what is believed now. REQUIRES: tells_of(access_point).
  ChainFactors refined(std::size_t access_point) const;

 private:
  struct Burst {
    RoomObservation observation;
    // [place], of a sample of where the device may be: its share, and what was said of it taken
    // out, so that the mean of what the places say is that of the whole room.
    std::vector<double> log_weight;
    std::map<std::size_t, std::vector<ChainMoments>> heard;  // by access point, [place]
    double turned = 0.0;  // [rad], by which what is believed has changed since it was sampled
  };
  bool sample(const Localizer& localizer, Burst& burst) const;
  void sample_again(const Localizer& localizer);
  PlacedBurst placed(const Burst& burst, std::size_t access_point) const;

  double likelihood_exponent_;
  std::deque<Burst> bursts_;  // oldest first
  std::size_t unused_ = 0;    // that came since is_due()
};

}  // namespace rayloc
