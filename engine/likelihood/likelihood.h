// Likelihood: how likely an access point's burst is when the device stands at a place whose rays
// are known (METHODS B2). One interface for several observables, all from the same rays:
//
//   partial          of every ray a part is known and a part is not; the default
//   coherent         every ray known, phase and strength: the normalised correlation
//   path_covariance  phases unknown; directions, relative delays and powers known
//   ratio_complex    products h_m conj(h_{m+1}) of adjacent antennas on every tone
//   ratio_amp        amplitudes of the ratios h_m / h_{m+1}, smoothed along the tones (METHODS A2)
//
// The first three are Gaussians in the coordinates of DelayBasis (ObservationModel has the
// formula), with the burst's gain, phase and delay profiled out. The others do not see gain, phase
// and delay at all: the residual e^2 of what is observed has an unknown variance, so that
//   ll = -N / 2 ln(e^2 + floor),   N: real numbers that the delay basis leaves independent.
//
// The level of what is heard enters none of them: transmitters change their power. That of one
// which does not is a likelihood of its own (level.h).
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/likelihood/nearby_likelihood.h"
#include "engine/likelihood/observation_model.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

enum class LikelihoodKind : std::uint8_t {
  kPartial,
  kCoherent,
  kPathCovariance,
  kRatioComplex,
  kRatioAmplitude,
};

// Names for configuration and people. The first is the default.
struct LikelihoodName {
  LikelihoodKind kind;
  std::string_view name;
  std::string_view description;
};
std::span<const LikelihoodName> likelihood_names();
// REQUIRES: one of these names.
LikelihoodKind likelihood_of(std::string_view name);

// It needs two antennas.
bool compares_antennas(LikelihoodKind kind);

// Of a burst, and whatever the kind needs beside its coordinates.
struct ObservedBurst {
  ObservedArray array;
  std::vector<std::complex<float>> features;  // of the ratios
  float scale = 1.0F;                         // of their squared differences
};

// A place of the grid. What a kind does not need is empty.
struct PlaceLikelihood {
  PlaceModel model;                           // the device anywhere in the cell
  PlaceModel sharp;                           // the device in the middle, for nearby()
  std::vector<std::complex<float>> features;  // [place within the cell][feature]
  bool reachable = false;                     // there is a ray
};

class Likelihood {
 public:
  static std::unique_ptr<const Likelihood> make(LikelihoodKind kind,
                                                const OfdmGrid& grid,
                                                std::size_t antennas);
  virtual ~Likelihood() = default;

  using Place = ObservationModel::Place;

  virtual PlaceLikelihood place(const Place& place, const ModelError& error) const = 0;
  // Of an unknown height. REQUIRES: !compares_antennas(kind): ratios change within centimetres of
  // height, so that they are compared at the height that is assumed.
  // The device at one of several heights above a place; without `sharp`.
  using WeightedPlace = ObservationModel::WeightedPlace;
  virtual PlaceLikelihood column(std::span<const WeightedPlace> heights,
                                 const ModelError& error) const;
  // Only what nearby() reads of a place.
  virtual PlaceLikelihood close(const Place& place, const ModelError& error) const;

  // h: [antenna][tone], chain gains removed.
  virtual ObservedBurst observe(std::span<const std::complex<double>> h) const = 0;

  // Cheaper than log_likelihood(), a lower bound, and what is worth a closer look.
  using Coarse = ObservationModel::Coarse;
  virtual Coarse coarse(const PlaceLikelihood& place, const ObservedBurst& observed) const = 0;
  // Up to a constant of the burst. `windows`: those of coarse().
  virtual double log_likelihood(const PlaceLikelihood& place,
                                const ObservedBurst& observed,
                                std::uint8_t windows) const = 0;
  double log_likelihood(const PlaceLikelihood& place, const ObservedBurst& observed) const {
    return log_likelihood(place, observed, coarse(place, observed).windows);
  }
  // Of the places in the cell of `of`, made from `place`; nothing where the kind does not tell them
  // apart. The arguments outlive it. REQUIRES: of.reachable.
  virtual std::unique_ptr<const NearbyLikelihood> nearby(const Place& place,
                                                         const PlaceLikelihood& of,
                                                         const ModelError& error,
                                                         const ObservedBurst& observed) const = 0;
  // The device anywhere: what every place is compared with.
  virtual PlaceLikelihood nowhere(const ModelError& error) const = 0;

 protected:
  Likelihood() = default;
  Likelihood(const Likelihood&) = default;
  Likelihood& operator=(const Likelihood&) = default;
};

}  // namespace rayloc
