// One pair of rays past a body, in a scalar T: computes the path's coefficient from the
// body's position.
#pragma once

#include <cmath>
#include <numbers>
#include <span>

#include "engine/em/cylinder_scatterer.h"
#include "engine/trace/path.h"
#include "engine/trace/scattering/scattering_end.h"

namespace rayloc {

// The images of both ends, and the body's position.
template <typename T>
struct ScatteringPlace {
  Vec3d source;
  Vec3d observer;
  T x{}, y{};

  Vec3<T> relative(const Vec3d& image) const {
    return {T(image.x) - x, T(image.y) - y, T(image.z)};
  }
  CylinderRoute<T> route(const CylinderScatterer& scatterer) const {
    return scatterer.route<T>(relative(source), relative(observer));
  }
};

// z, softly limited to the body's height.
template <typename T>
T limited_height(const T& z, const CylinderBody& body) {
  using std::sqrt;
  constexpr double kSoftness = 0.05;  // [m]
  const auto away = [&](double end) {
    const T d = z - T(end);
    return sqrt(d * d + T(kSoftness * kSoftness));
  };
  const double top = body.base + body.height;
  return T(0.5) * (T(body.base + top) + away(body.base) - away(top));
}

template <typename T>
struct ScatteredCoefficient {
  Complex<T> a;  // Path::a
  T length{};    // [m]
};

// `in`, `out`: the rays at the route's point. The body's v is -theta^ of `away` on both sides; its
// h is -phi^ of the incident ray's `away`, which is opposite to the direction of travel, and phi^
// of the outgoing one's.
template <typename T>
ScatteredCoefficient<T> scattered(const CylinderScatterer& scatterer,
                                  const CylinderRoute<T>& route,
                                  const BodyRay<T>& in,
                                  const BodyRay<T>& out) {
  const CylinderScattering<T> s = scatterer.scatter(route);
  const Complex<T> v = s.vv * in.theta + s.vh * in.phi;
  const Complex<T> h = s.hv * in.theta + s.hh * in.phi;
  const Complex<T> sum = out.theta * v - out.phi * h;
  const T scale(scatterer.wavelength() / (4.0 * std::numbers::pi));
  return {{scale * sum.re, scale * sum.im}, s.length};
}

}  // namespace rayloc
