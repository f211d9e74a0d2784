// refit_chains: new chain gains of a calibrated access point after a power cycle, from a few
// transmitters at known places; everything else of the room stays as calibrated (METHODS B4, step
// 1, alone).
//
// A power cycle turns the phases of the chains; their ripple over the band is that of filters and
// stays, and their level about (kChainLevelSigma). From fewer than kRippleSpots spots a complex
// factor and a delay of each chain are therefore fitted on top of the old gains; from more, the
// gains of every tone (chain_ripple()).
//
// Of a transmitter whose array was kept from before the power cycle (the empty room of a
// PersonReference) the chains are compared with that, tone by tone: nothing of the room needs to be
// right.
//
// One spot says nothing about itself: a wrong place turns the phases as a power cycle would, and is
// seen only where the spectrum does not fit. Two and more contradict each other.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/room/room_model.h"

namespace rayloc {

// What an access point heard of a transmitter at a known place.
struct KnownSpot {
  Vec3d position;  // [m]
  DeviceModel device;
  std::vector<std::complex<double>> h;  // [core][tone], BurstObservation::h
  // The same before the power cycle, chains removed; empty: what the room expects counts.
  std::vector<std::complex<double>> usual = {};
};

// Squared normalised correlations of measured and expected arrays when the room was calibrated, at
// points that did not enter the calibration.
struct UsualFit {
  double median = 0.0;
  double lower_quartile = 0.0;
  double upper_quartile = 0.0;
};

struct ChainRefitOptions {
  double place_sigma = 0.01;      // [m] along each axis, of the places stated
  std::optional<UsualFit> usual;  // nothing: the fit is compared with nothing
  double most_sigma = 0.52;       // [rad], 30 degrees: by what the room leaves unexplained
};

struct ChainRefit {
  ChainGains gains;
  // Of the phase of each core [rad]. The difference of two has the root of the sum of the squares.
  std::vector<double> sigma;
  double fit = 0.0;       // median of the spots' squared normalised correlation
  std::size_t spots = 0;  // that a ray reaches, or with an array from before
  bool ripple = false;    // of every tone, else the old ripple
};

// A count, chosen: fewer do not average out what no ray explains.
inline constexpr std::size_t kRippleSpots = 12;

// An Error when no ray of the room reaches a spot, when the phase of a chain would be known too
// badly (options.most_sigma), or when the spots fit far worse than usual: more
// than kFarBelowUsual robust standard deviations below on the scale log(c / (1 - c)), one of which
// is taken as at least kLeastSpread. It names both numbers.
// REQUIRES: room.access_points[access_point].gains not empty; every h of its size.
inline constexpr double kFarBelowUsual = 3.5;
// [log odds], chosen: surveys whose fits agree too well refuse nothing.
inline constexpr double kLeastSpread = 0.5;
Expected<ChainRefit> refit_chains(const RoomModel& room,
                                  std::size_t access_point,
                                  std::span<const KnownSpot> spots,
                                  const ChainRefitOptions& options = {});

}  // namespace rayloc
