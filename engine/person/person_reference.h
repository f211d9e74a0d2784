// PersonReference: what is known beforehand of the links that look for a person (device-free,
// METHODS B5): a fixed transmitter, what each access point hears of it in the empty room, and the
// person.
//
//   y ~ H0 + a dH(P)
//
// H0 is measured; dH, what a body at P adds, is traced (engine/trace/scattering/scattering.h). The
// measured array is known up to a complex factor and a delay only, so H0 is given those of the
// traced room, which dH has. What is left of them, and what is wrong with the body, goes into one
// complex `a` for each access point, fitted on people at known places where there were such.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/scattering/target_body.h"

namespace rayloc {

// The person that is expected, and how far dH may be from its model. The defaults of the errors are
// those of a person of whom nothing was measured.
struct PersonModel {
  TargetBody body{.semi_axes = {0.165, 0.165}, .yaw = 0.0, .base = 0.0, .height = 1.7};
  double strength_variance = 0.1;  // v: of each scattered ray, share of its power
  // w: the same, of what is wrong alike at all antennas of an array: the body, and the surfaces
  // before and behind it.
  double way_variance = 0.0;
  // [m], of a body's front about the round one's: people are oval, turn, and have arms. What passes
  // them straight on does not see it.
  double front_sigma = 0.0;
  double diffuse = 0.1;               // d: scattered power that is not traced, share of the traced
  double noise = 5e-4;                // n: share of the power that nothing explains
  double likelihood_exponent = 0.35;  // exponent of the likelihood
  // Difference of log-likelihoods that a second person must make to be believed: what is wrong with
  // the model of one is explained by another to some extent. Unknown without known places, and
  // then no second person is looked for.
  std::optional<double> second_person;
};

// One access point that hears the fixed transmitter.
struct PersonLink {
  std::size_t access_point = 0;  // of RoomModel::access_points
  // H0, [core][tone], chain gains removed, with the level, phase and delay of the traced room.
  std::vector<std::complex<double>> empty;
  std::complex<double> scale = 1.0;  // a
  double room_fit = 0.0;  // squared correlation of the measured and the traced empty room
};

// Where people can be, beyond the bounds of the room: a circle in plan.
struct PersonArea {
  double x = 0.0;       // [m]
  double y = 0.0;       // [m]
  double radius = 0.0;  // [m]
};

struct PersonReference {
  MacAddress mac;           // of the fixed transmitter
  Transmitter transmitter;  // where it was found to be
  std::vector<PersonLink> links;
  PersonModel person;
  std::optional<PersonArea> area;
  std::string id;  // hash of what it was made from
};

// An Error when a link is of an access point that the room does not have as it was recorded, or
// that is not calibrated.
Expected<void> check_link(const RoomModel& room, const PersonLink& link);

}  // namespace rayloc
