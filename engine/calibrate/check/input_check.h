// check_calibration_inputs: checks, before any fit, that a survey was made as stated and that the
// access points are mounted and wired as the site states.
//
// Recordings and places that do not match still have a best fit, but a bad one. The stated inputs
// are therefore compared with usual mistakes, using only the floor plan and the chain gains. Each
// hypothesis fits its own gains on one half of the points and is tested on the other half
// (AccessPointCalibrator::crossed_correlations()). The comparison uses the squared normalised
// correlation of each point, in pairs: a room that is modelled badly is modelled badly under both
// hypotheses.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/calibrate/check/misfitting_points.h"
#include "engine/calibrate/check/paired_comparison.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A mistake that was tried, and how well it explains the recordings of the access points
// concerned.
struct TriedMistake {
  enum class Kind : std::uint8_t {
    kPlaces,      // of the survey
    kRecordings,  // given for other access points
    kArray,       // of the site: an access point's yaw, or the order of its antennas
    kCarrier,     // of the site: its channel
  };
  Kind kind = Kind::kPlaces;
  std::string what;           // "access point 'ap1' rotated by 180 degrees"
  std::string remedy;         // "in site.toml, of access point 'ap1': yaw_deg = 143 instead of -37"
  std::string message;        // both, and how much more it explains
  double stated = 0.0;        // mean correlation as stated
  double explained = 0.0;     // the same with the mistake
  double gained = 0.0;        // the difference, summed over the points
  double significance = 0.0;  // PairedComparison::significance()
};

struct InputCheck {
  std::vector<TriedMistake> tried;  // ordered by gain, largest first
  // Mistakes that explain the survey clearly better than the stated inputs: the one that gains
  // most, or one for each access point that is mounted otherwise than stated. Empty: the inputs are
  // as stated, or the data do not decide.
  std::vector<TriedMistake> found;
  // misfitting_points() of the traces in the stated room, if no mistake was found.
  std::vector<PointRefusal> misfits;
};

// The following are tried: x, y and z exchanged, axes reversed or counted from the other end, rows
// one off or in reverse order; recordings given for other access points (every order of up to
// kAllOrders access points); for each access point mistakes_of_array().
//
// "Clearly": the mean of the paired differences exceeds kClearly of its standard errors. For a
// mistake as good as the truth, that happens once in 740 comparisons; for a right survey the mean
// is negative. With fewer than kFewestPairs pairs of a point and an access point no result is
// given. The places must also explain their recordings clearly better than places half of the
// survey away: among many mistakes, some explain a survey in disorder better than the stated one. A
// mistake of arrays or carriers must also explain kSubstantial of the stated residual: antennas
// that are seen from one side only are nearly alike in two orders, and then the errors of the plan,
// which all points share, decide.
//
// `room`: the uncalibrated one. Points that no ray reaches are left out of the comparison.
// REQUIRES: every h of a point is empty or has as many values as its access point has cores x
// tones.
constexpr double kClearly = 3.0;
constexpr double kSubstantial = 0.1;  // a ratio, chosen: share of the residual as stated
bool is_clear(const TriedMistake& mistake);
InputCheck check_calibration_inputs(const RoomModel& room,
                                    std::span<const CalibrationPoint> points);

// Carriers one and two bandwidths off that of the site. Under a floor plan they explain nearly the
// same, so they are tried only after a calibration has failed.
std::vector<TriedMistake> try_carriers(const RoomModel& room,
                                       std::span<const CalibrationPoint> points);

}  // namespace rayloc
