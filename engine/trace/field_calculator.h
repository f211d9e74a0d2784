// The field along a path: antenna, interactions, antenna, spreading.
//
// Written in a scalar T, so that with dual numbers the coefficient carries derivatives by
// both ends, the planes, the materials and the orientations. The effect of a face on a wave
// is in interactions/.
//
// The whole path follows from the image of the receiver, which gives direction of departure and
// length. Vertices are not needed (image_method.h computes them).
#pragma once

#include <cstddef>
#include <numbers>
#include <span>

#include "engine/base/check.h"
#include "engine/base/complex.h"
#include "engine/base/mat3.h"
#include "engine/base/vec3.h"
#include "engine/em/antenna_field.h"
#include "engine/trace/image_method.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/interactions/wave.h"
#include "engine/trace/path.h"

namespace rayloc {

template <typename T>
struct LinkEnd {
  Vec3<T> position;  // [m], world
  AntennaPattern pattern = AntennaPattern::kIsotropic;
  Polarization polarization = Polarization::kVertical;
  Mat3<T> world_from_antenna;
};

template <typename T>
struct PathCoefficient {
  Complex<T> a;         // Path::a
  T length{};           // [m], unfolded
  Vec3<T> departure{};  // unit, direction of travel at the transmitter
  Vec3<T> arrival{};    // unit, direction of travel at the receiver
};

// The wave that the transmitter radiates in that direction.
template <typename T>
Wave<T> radiated(const LinkEnd<T>& transmitter, const Vec3<T>& direction) {
  return {{antenna_field(transmitter.pattern,
                         transmitter.polarization,
                         transmitter.world_from_antenna,
                         direction),
           {}},
          direction};
}

// The receiver's response to a wave after a path of `length` [m].
template <typename T>
Complex<T> received(const LinkEnd<T>& receiver,
                    const Wave<T>& wave,
                    const T& length,
                    const T& wavelength) {
  const Vec3<T> response = antenna_field(
      receiver.pattern, receiver.polarization, receiver.world_from_antenna, -wave.direction);
  const T spreading = wavelength / (T(4.0 * std::numbers::pi) * length);
  return {spreading * dot(wave.field.re, response), spreading * dot(wave.field.im, response)};
}

// The path from transmitter to receiver over `facets`, with the kinds of `interactions`. REQUIRES:
// interactions.size() == facets.size(); ends and images are not at the same position.
template <typename T>
PathCoefficient<T> path_coefficient(std::span<const Interaction> interactions,
                                    std::span<const Facet<T>> facets,
                                    const LinkEnd<T>& transmitter,
                                    const LinkEnd<T>& receiver,
                                    const T& wavelength) {
  RAYLOC_CHECK(interactions.size() == facets.size());
  Vec3<T> image = receiver.position;
  for (std::size_t i = facets.size(); i > 0; --i) {
    if (is_mirror(interactions[i - 1].kind)) {
      image = mirror(facets[i - 1].plane, image);
    }
  }
  const Vec3<T> unfolded = image - transmitter.position;
  PathCoefficient<T> path;
  path.length = norm(unfolded);
  path.departure = (T(1) / path.length) * unfolded;
  Wave<T> wave = radiated(transmitter, path.departure);
  for (std::size_t i = 0; i < facets.size(); ++i) {
    wave = visit_interaction(interactions[i].kind, [&](auto met) {
      return decltype(met)::apply(wave, facets[i], wavelength);
    });
  }
  path.arrival = wave.direction;
  path.a = received(receiver, wave, path.length, wavelength);
  return path;
}

}  // namespace rayloc
