// refit_chains: new chain gains of a calibrated access point after a power cycle, from a few
// transmitters at known places; everything else of the room stays as calibrated (METHODS B4, step
// 1, alone).
//
// A power cycle changes the phases of the chains; their ripple over the band is due to filters and
// stays, and so does their amplitude approximately (kChainGainSigma). From fewer than kRipplePoints
// points a complex factor and a delay of each chain are therefore fitted on top of the old gains;
// from more, the gains of every tone (chain_ripple()).
//
// For a transmitter with an array recorded before the power cycle (the empty room of a
// PersonReference), the chains are compared with that array tone by tone: the model of the room
// need not be right.
//
// One point cannot verify itself: a wrong place changes the phases like a power cycle and is
// detected only where the spectrum does not fit. Two and more points contradict each other.
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

// Observation by an access point of a transmitter at a known place.
struct ReferencePoint {
  Vec3d position;  // [m]
  DeviceModel device;
  std::vector<std::complex<double>> h;  // [rx_chain][tone], BurstObservation::h
  // The same before the power cycle, chains removed; empty: the room's expected array is used.
  std::vector<std::complex<double>> usual = {};
};

// Squared normalised correlations of measured and expected arrays at the time of the room's
// calibration, at points that did not enter the calibration.
struct UsualFit {
  double median = 0.0;
  double lower_quartile = 0.0;
  double upper_quartile = 0.0;
};

struct ChainRefitOptions {
  double place_sigma = 0.01;      // [m] along each axis, of the places stated
  std::optional<UsualFit> usual;  // nullopt: the fit is not compared
  double most_sigma = 0.52;       // [rad], 30 degrees: limit of a phase's error from the residual
};

struct ChainRefit {
  ChainGains gains;
  // [rad], of the phase of each core. The sigma of a difference is the root of the sum of squares.
  std::vector<double> sigma;
  double fit = 0.0;        // median of the points' squared normalised correlation
  std::size_t points = 0;  // reached by a ray, or with an earlier array
  bool ripple = false;     // refitted per tone; false: old ripple
};

// A count, chosen: with fewer points, power that no ray explains does not average out.
inline constexpr std::size_t kRipplePoints = 12;

// An Error when no ray of the room reaches a point, when the phase of a chain would be too
// inaccurate (options.most_sigma), or when the points fit far worse than usual: more than
// kFarBelowUsual robust standard deviations below on the scale log(c / (1 - c)), where one
// deviation is at least kMinSpread. The Error contains both numbers.
// REQUIRES: room.access_points[access_point].gains not empty; every h of its size.
inline constexpr double kFarBelowUsual = 3.5;
// [log odds], chosen: surveys with nearly equal fits must not cause a refusal.
inline constexpr double kMinSpread = 0.5;
Expected<ChainRefit> refit_chains(const RoomModel& room,
                                  std::size_t access_point,
                                  std::span<const ReferencePoint> points,
                                  const ChainRefitOptions& options = {});

}  // namespace rayloc
