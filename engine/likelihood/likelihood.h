// Likelihood: how likely an access point's burst is for a device at a place with known rays
// (METHODS B2). One interface for several observables, all from the same rays:
//
//   partial          part of each ray is known and part is not; the default
//   coherent         every ray known, phase and strength: the normalised correlation
//   path_covariance  phases unknown; directions, relative delays and powers known
//   ratio_complex    products h_m conj(h_{m+1}) of adjacent antennas on every tone
//   ratio_amp        amplitudes of the ratios h_m / h_{m+1}, smoothed along the tones (METHODS A2)
//
// The first three are Gaussians in the coordinates of DelayBasis (formula: ObservationModel), with
// the burst's gain, phase and delay profiled out. The others do not depend on gain, phase and
// delay: the residual e^2 of the observable has an unknown variance, so that
//   ll = -N / 2 ln(e^2 + floor),   N: real numbers that the delay basis leaves independent.
//
// The received power enters none of them, because transmitters change their power. For a
// transmitter with constant power it has a likelihood of its own (received_power.h).
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

// Names for configuration and users. The first is the default.
struct LikelihoodName {
  LikelihoodKind kind;
  std::string_view name;
  std::string_view description;
};
std::span<const LikelihoodName> likelihood_names();
// REQUIRES: one of these names.
LikelihoodKind likelihood_of(std::string_view name);

// True if the likelihood needs two antennas.
bool compares_antennas(LikelihoodKind kind);

// A preprocessed burst, with the data that the kind needs besides its coordinates.
struct ObservedBurst {
  ObservedArray array;
  std::vector<std::complex<float>> features;  // of the ratios
  float scale = 1.0F;                         // of their squared differences
};

// A place of the grid. Members that a kind does not need are empty.
struct PlaceLikelihood {
  PlaceModel model;                           // the device anywhere in the cell
  PlaceModel sharp;                           // the device at the centre, of close()
  std::vector<std::complex<float>> features;  // [place within the cell][feature]
  bool reachable = false;                     // at least one ray exists
};

class Likelihood {
 public:
  static std::unique_ptr<const Likelihood> make(LikelihoodKind kind,
                                                const OfdmGrid& grid,
                                                std::size_t antennas);
  virtual ~Likelihood() = default;

  using Place = ObservationModel::Place;

  virtual PlaceLikelihood place(const Place& place, const ModelError& error) const = 0;
  // Model for an unknown height: the device at one of several heights above a place.
  // REQUIRES: !compares_antennas(kind): ratios change within centimetres of height, so
  // they are compared at the assumed height.
  using WeightedPlace = ObservationModel::WeightedPlace;
  virtual PlaceLikelihood column(std::span<const WeightedPlace> heights,
                                 const ModelError& error) const;
  // The part of a place that nearby() reads, and no other member.
  virtual PlaceLikelihood close(const Place& place, const ModelError& error) const;

  // h: [antenna][tone], chain gains removed.
  virtual ObservedBurst observe(std::span<const std::complex<double>> h) const = 0;

  // A cheap lower bound of log_likelihood(), with the windows of delays to evaluate finely.
  using Coarse = ObservationModel::Coarse;
  virtual Coarse coarse(const PlaceLikelihood& place, const ObservedBurst& observed) const = 0;
  // Up to a constant of the burst. `windows`: from coarse().
  virtual double log_likelihood(const PlaceLikelihood& place,
                                const ObservedBurst& observed,
                                std::uint8_t windows) const = 0;
  double log_likelihood(const PlaceLikelihood& place, const ObservedBurst& observed) const {
    return log_likelihood(place, observed, coarse(place, observed).windows);
  }
  // Likelihood of the places in the cell of `of`, close(place); null if the kind cannot separate
  // them. The arguments must outlive the result. REQUIRES: the place has rays.
  virtual std::unique_ptr<const NearbyLikelihood> nearby(const Place& place,
                                                         const PlaceLikelihood& of,
                                                         const ModelError& error,
                                                         const ObservedBurst& observed) const = 0;
  // Null model with the device anywhere: the reference for every place.
  virtual PlaceLikelihood null_model(const ModelError& error) const = 0;

 protected:
  Likelihood() = default;
  Likelihood(const Likelihood&) = default;
  Likelihood& operator=(const Likelihood&) = default;
};

}  // namespace rayloc
