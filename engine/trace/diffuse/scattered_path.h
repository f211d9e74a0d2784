// A path from one antenna to a patch of a rough surface and on to another antenna: its power, and
// its field without the patch's random phase.
//
// Both ends send a wave to the patch, over their interactions; antennas and faces are reciprocal.
// With the direction d of one wave, mirrored to d' by the patch, and k the direction to the other
// end, the field keeps its polarisation in this sense: mirrored as d is, then rotated by the
// smallest rotation from d' to k. That is smooth everywhere and symmetric in both ends; the
// directions te and tm, which Sionna RT keeps, rotate abruptly at normal incidence. The share k_x
// of the power is in the other polarisation, whose field changes its sign when ends are exchanged.
//
// Written in a scalar T, so that with dual numbers power and field carry derivatives by both ends,
// the materials and the lobes. The patch is fixed.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "engine/base/complex.h"
#include "engine/base/vec3.h"
#include "engine/em/scattering_lobe.h"
#include "engine/trace/field_calculator.h"
#include "engine/trace/image_method.h"
#include "engine/trace/interactions/interaction.h"

namespace rayloc {

// A point of a surface that represents the area about it.
struct ScatteringPatch {
  std::uint32_t surface = 0;  // index into Scene::surfaces()
  Vec3d position;             // [m], world
  double area = 0.0;          // [m^2]
};

// A material as a rough surface.
template <typename T>
struct RoughMaterial {
  ScatteringLobe<T> lobe;
  T scattering{};  // S
  T xpd{};         // k_x
};

// The wave from an end when it meets a patch, without spreading and phase.
template <typename T>
struct LegToPatch {
  Wave<T> wave;
  T length{};           // [m], unfolded
  Vec3<T> departure{};  // unit, from the end
};

// Leg over `interactions`, from the end on; `facet_of(surface)` returns a Facet<T>. REQUIRES: none
// of them is an edge; end and patch are not at one position.
template <typename T, typename FacetOf>
LegToPatch<T> leg_to_patch(const LinkEnd<T>& end,
                           std::span<const Interaction> interactions,
                           const FacetOf& facet_of,
                           const Vec3d& patch,
                           const T& wavelength) {
  std::vector<Facet<T>> facets;
  facets.reserve(interactions.size());
  for (const Interaction& interaction : interactions) {
    facets.push_back(facet_of(interaction.surface));
  }
  Vec3<T> source = end.position;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    source = is_mirror(interactions[i].kind) ? mirror(facets[i].plane, source) : source;
  }
  const Vec3<T> path = Vec3<T>{T(patch.x), T(patch.y), T(patch.z)} - source;
  LegToPatch<T> leg;
  leg.length = norm(path);
  leg.departure = (T(1) / leg.length) * path;
  for (std::size_t i = facets.size(); i > 0; --i) {
    if (is_mirror(interactions[i - 1].kind)) {
      leg.departure = interactions::Reflection::mirrored(leg.departure, facets[i - 1].plane.normal);
    }
  }
  leg.wave = radiated(end, leg.departure);
  for (std::size_t i = 0; i < facets.size(); ++i) {
    leg.wave = visit_interaction(interactions[i].kind, [&](auto kind) {
      return decltype(kind)::apply(leg.wave, facets[i], wavelength);
    });
  }
  return leg;
}

template <typename T>
struct ScatteredPath {
  T per_area{};      // [1/m^2], of |a|^2, for a receiver of all polarisations with gain 1
  Complex<T> co;     // response of both antennas to the kept polarisation
  Complex<T> cross;  // and to the other one
  T length{};        // [m], between the ends

  // [1/m^2], of |a|^2.
  T power(const RoughMaterial<T>& rough) const {
    return per_area * ((T(1) - rough.xpd) * abs2(co) + rough.xpd * abs2(cross));
  }
};

// G of a face, at that cosine of incidence.
template <typename T>
T smooth_reflectance(const T& cosine, const Facet<T>& facet, const T& wavelength) {
  const SlabTable::Pair<T> slab =
      interactions::Reflection::smooth_coefficients(cosine, facet, wavelength);
  const T sine2 = T(1) - cosine * cosine;
  const Complex<T> tm{sine2 * slab.excess.re - slab.te.re, sine2 * slab.excess.im - slab.te.im};
  return T(0.5) * (abs2(slab.te) + abs2(tm));
}

// `facet`: the patch's. REQUIRES: both legs come from the same side of it, and not along it.
template <typename T>
ScatteredPath<T> scattered_path(const RoughMaterial<T>& rough,
                                const Facet<T>& facet,
                                const LegToPatch<T>& in,
                                const LegToPatch<T>& out,
                                const T& wavelength) {
  const Vec3<T>& normal = facet.plane.normal;
  const auto mirrored = [&](const Vec3<T>& v) {
    return interactions::Reflection::mirrored(v, normal);
  };
  const Vec3<T> from = mirrored(in.wave.direction);
  const Vec3<T> to = -out.wave.direction;
  const T cos_reflected = dot(from, to);
  // Across `from`, the smallest rotation maps v to v - (v . to) (from + to) / (1 + from . to).
  const Vec3<T> middle = (T(1) / (T(1) + cos_reflected)) * (from + to);
  const auto rotated = [&](const Vec3<T>& v) { return v - dot(v, to) * middle; };
  const ComplexVec3<T> kept{rotated(mirrored(in.wave.field.re)),
                            rotated(mirrored(in.wave.field.im))};
  const ComplexVec3<T> other{cross(to, kept.re), cross(to, kept.im)};
  const auto received = [&](const ComplexVec3<T>& field) {
    const ComplexVec3<T>& at = out.wave.field;
    return Complex<T>{dot(field.re, at.re) - dot(field.im, at.im),
                      dot(field.re, at.im) + dot(field.im, at.re)};
  };
  const auto end = [&](const LegToPatch<T>& leg) {
    const T cosine = cosine_of_incidence(leg.wave.direction, facet);
    return typename ScatteringLobe<T>::End{cosine, smooth_reflectance(cosine, facet, wavelength)};
  };
  ScatteredPath<T> path;
  const T cos_back = dot(in.wave.direction, out.wave.direction);
  const T spread =
      rough.scattering * wavelength / (T(4.0 * std::numbers::pi) * in.length * out.length);
  path.per_area = spread * spread * rough.lobe.weight(end(in), end(out), cos_reflected, cos_back);
  path.co = received(kept);
  path.cross = received(other);
  path.length = in.length + out.length;
  return path;
}

}  // namespace rayloc
