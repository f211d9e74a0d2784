// PersonReference: prior data of the links that detect a person (device-free, METHODS B5): a fixed
// transmitter, the array that each access point receives from it in the empty room, and the
// person.
//
//   y ~ H0 + a dH(P)
//
// H0 is measured; dH, the effect of a body at P, is traced (engine/trace/scattering/scattering.h).
// The measured array is known up to a complex factor and a delay only, so H0 is given those of the
// traced room, as dH has. The residual, and errors of the body's model, are contained in one
// complex `a` per access point, fitted on people at known places where available.
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

// The expected person, and the errors of dH's model. The defaults of the errors are those of a
// person without measurements.
struct PersonModel {
  TargetBody body{.semi_axes = {0.165, 0.165}, .yaw = 0.0, .base = 0.0, .height = 1.7};
  double strength_variance = 0.1;  // v: of each scattered ray, share of its power
  // w: the same, for errors common to all antennas of an array: the body, and the surfaces before
  // and behind it.
  double path_variance = 0.0;
  // [m], deviation of a body's front from the round one's: people are oval, turn, and have arms.
  // Waves that pass straight on are not affected.
  double front_offset_sigma = 0.0;
  double diffuse = 0.1;               // d: scattered power that is not traced, share of the traced
  double noise = 5e-4;                // n: share of the power that no model explains
  double likelihood_exponent = 0.35;  // exponent of the likelihood
  // Difference of log-likelihoods that a second person must exceed to be accepted: a second person
  // partly explains errors of the model of the first. nullopt without known places; then no second
  // person is searched for.
  std::optional<double> second_person;
};

// One access point that receives the fixed transmitter.
struct PersonLink {
  std::size_t access_point = 0;  // of RoomModel::access_points
  // H0, [rx_chain][tone], chain gains removed, with the traced room's amplitude, phase and delay.
  std::vector<std::complex<double>> empty;
  std::complex<double> scale = 1.0;  // a
  double room_fit = 0.0;  // squared correlation of the measured and the traced empty room
};

// Limit of people's places in addition to the bounds of the room: a circle in plan.
struct PersonArea {
  double x = 0.0;       // [m]
  double y = 0.0;       // [m]
  double radius = 0.0;  // [m]
};

struct PersonReference {
  MacAddress mac;           // of the fixed transmitter
  Transmitter transmitter;  // at its fitted place
  std::vector<PersonLink> links;
  PersonModel person;
  std::optional<PersonArea> area;
  std::string id;  // hash of its inputs
};

// An Error when a link refers to an access point that the room does not have as recorded, or that
// is not calibrated.
Expected<void> check_link(const RoomModel& room, const PersonLink& link);

}  // namespace rayloc
