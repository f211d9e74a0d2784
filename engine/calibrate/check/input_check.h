// check_calibration_inputs: whether a survey was made the way it was stated, and the access points
// stand and are wired as the site states, before anything is fitted to it.
//
// Recordings and places that do not belong together still have a best fit; only it is a bad one.
// What was stated is therefore compared with the mistakes that people are known for, under the
// floor plan and the chain gains alone. Each hypothesis fits its own gains, on one half of the
// points, and is judged by the other half (AccessPointCalibrator::crossed_correlations()). What is
// compared is the squared normalised correlation of each point, in pairs: a room that is modelled
// badly is so under both hypotheses.
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

// A mistake that was tried, and how well it explains the recordings of the access points that it is
// about.
struct TriedMistake {
  enum class Kind : std::uint8_t {
    kPlaces,      // of the survey
    kRecordings,  // given for other access points
    kArray,       // of the site: an access point's yaw, or the order of its antennas
    kCarrier,     // of the site: its channel
  };
  Kind kind = Kind::kPlaces;
  std::string what;           // "access point 'ap1' turned by 180 degrees"
  std::string remedy;         // "in site.toml, of access point 'ap1': yaw_deg = 143 instead of -37"
  std::string message;        // both, and by how much it explains more
  double stated = 0.0;        // mean correlation as stated
  double explained = 0.0;     // and with the mistake
  double gained = 0.0;        // the difference, summed over the points
  double significance = 0.0;  // PairedComparison::significance()
};

struct InputCheck {
  std::vector<TriedMistake> tried;  // what gains most first
  // What explains the survey clearly better than what was stated: the mistake that gains most, or
  // one of each access point that stands otherwise than stated. Empty: the inputs are as stated, or
  // nobody can tell.
  std::vector<TriedMistake> found;
  // misfitting_points() of what was traced in the room as it is, where nothing was found.
  std::vector<PointRefusal> misfits;
};

// Tried are x, y and z exchanged, axes that run the other way or from the other end, rows one off
// or in reverse order; recordings given for other access points (of up to kAllOrders access points
// in every order); of each access point mistakes_of_array().
//
// "Clearly": the mean of the paired differences exceeds kClearly of its standard errors. Were a
// mistake as good as the truth, that happens once in 740 comparisons; for a right survey the mean
// is negative. With fewer than kFewestPairs pairs of a point and an access point nothing is said.
// The places must also explain their recordings clearly better than places half of the survey away
// do: of many mistakes some explain a survey in disorder better than what was stated.
// Of arrays and carriers the mistake must also explain kSubstantial of what is left as stated:
// antennas that are seen from one side only look nearly the same in two orders, and then the errors
// of the plan decide, which all points share.
//
// `room`: the uncalibrated one. Points that no ray reaches are left out of the comparison.
// REQUIRES: every h of a point is empty or has as many values as its access point has cores x
// tones.
constexpr double kClearly = 3.0;
constexpr double kSubstantial = 0.1;  // a ratio, chosen: of what is left unexplained as stated
bool is_clear(const TriedMistake& mistake);
InputCheck check_calibration_inputs(const RoomModel& room,
                                    std::span<const CalibrationPoint> points);

// Carriers one and two bandwidths beside that of the site. Under a floor plan they explain nearly
// the same, so they are for a calibration that has failed already.
std::vector<TriedMistake> try_carriers(const RoomModel& room,
                                       std::span<const CalibrationPoint> points);

}  // namespace rayloc
