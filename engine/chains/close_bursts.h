// CloseBursts: bursts with their candidate places, centimetres apart, as received by all access
// points with known chains.
//
// A burst is represented by a sample of its candidate places (sample_places()), drawn with the
// chain states accepted at that time. After a change of these states it is drawn again.
//
// A grid cell is wider than a wavelength: the phase information of a cell is smeared, and the state
// that maximises its mean is some degrees off the right one. Once the chains are known roughly, the
// places within the cells can be distinguished, and the observations of one place by several access
// points determine the phases of each.
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

  // `observation`: of access points with known chains, all of their antennas. A burst that no place
  // explains is left out; the oldest burst is dropped when full.
  void add(const Localizer& localizer, const RoomObservation& observation);

  // The accepted state of an access point of the room has changed by these factors, [chain].
  void accept(std::size_t access_point, std::span<const std::complex<double>> factor);
  void clear();

  // True if enough bursts were added since it last returned true to improve the factors.
  bool is_due();
  // True if enough of the bursts include the access point.
  bool includes(std::size_t access_point) const;
  // Its factors relative to the accepted state. REQUIRES: includes(access_point).
  ChainFactors refined(std::size_t access_point) const;

 private:
  struct Burst {
    RoomObservation observation;
    // [place], of the sampled places: ln of the share, minus the log-likelihoods used for drawing,
    // so that the mean of the likelihood over the places is that over the whole room.
    std::vector<double> log_weight;
    std::map<std::size_t, std::vector<ChainMoments>> received;  // by access point, [place]
    double rotated = 0.0;  // [rad], change of the accepted states since it was sampled
  };
  bool sample(const Localizer& localizer, Burst& burst) const;
  void sample_again(const Localizer& localizer);
  PlacedBurst placed(const Burst& burst, std::size_t access_point) const;

  double likelihood_exponent_;
  std::deque<Burst> bursts_;  // oldest first
  std::size_t unused_ = 0;    // added since is_due()
};

}  // namespace rayloc
