// PersonScattering: the rays by which a person changes the link between a fixed transmitter and an
// array, in the calibrated room: shadow and scattering over every pair of paths to and from the
// body (engine/trace/scattering/scattering.h), with the corrections of the surfaces on these paths.
//
// A ray is valid in a small square about the place it was traced for: the logarithm of its field is
// assumed linear in the place. At 5 GHz and 1 m from a device a corner 7 cm off is 0.25 rad wrong.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/expected.h"
#include "engine/room/room_model.h"
#include "engine/trace/scattering/scattering.h"

namespace rayloc {

struct ScatteredRay {
  std::complex<double> amplitude;  // without propagation phase
  double length = 0.0;             // [m]
  // Derivatives of the logarithm of the field at the carrier by the person's place [1/m].
  std::complex<double> slope_x;
  std::complex<double> slope_y;
  Vec3d departure;  // unit vector, direction of departure from the transmitter
  // Path number, shared by the rays of several antennas over the same surfaces.
  std::size_t path = 0;
};

inline constexpr int kPersonDepth = 2;  // largest useful number of reflections past a person

using ScatteredRays = std::vector<std::vector<ScatteredRay>>;  // [element][ray]

// The same rays for a transmitter moved by `shift`, millimetres: only lengths change.
ScatteredRays moved_transmitter(ScatteredRays rays, const Vec3d& shift);

class PersonScattering {
 public:
  // `depth`: reflections on both paths together. Waves that pass through objects are left out: they
  // are weak, many, and have the least known phases.
  // An Error names the property of the body that cannot be used.
  static Expected<PersonScattering> create(const RoomModel& room,
                                           std::size_t access_point,
                                           const Transmitter& transmitter,
                                           const TargetBody& body,
                                           int depth);

  // nullopt where the transmitter or an antenna would be inside the body.
  std::optional<ScatteredRays> at(const TargetPosition& place) const;

  // The same, for each element, as paths with their derivatives: exact only at the place.
  std::optional<std::vector<TargetPaths>> paths(const TargetPosition& place) const;

 private:
  PersonScattering(const RoomModel& room, std::vector<TargetLink> links);

  std::vector<TargetLink> links_;                 // for each element
  std::vector<std::complex<double>> correction_;  // RoomModel::surface_correction
  double angular_carrier_;                        // [rad/s]
};

}  // namespace rayloc
