// The templates of cylinder_scatterer.h; include that.
#pragma once

#include <algorithm>
#include <type_traits>

#include "engine/base/dual.h"
#include "engine/em/cylinder_scatterer.h"

namespace rayloc {
namespace cylinder {

// Waves whose cosine of elevation is below the first are left out, above the second whole.
inline constexpr double kSteep = 0.18;
inline constexpr double kLevel = 0.26;
// The same for the distance of an end from the axis, in larger semi-axes.
inline constexpr double kTouching = 1.0;
inline constexpr double kFree = 1.05;
// The shorter way by the surface is blurred by this share of the body's size around forward
// scattering, where it has a kink.
inline constexpr double kBlur = 0.1;

// 0 below `from`, 1 above `to`, twice differentiable.
template <typename T>
T smooth_step(const T& x, double from, double to) {
  const T t = (x - T(from)) * T(1.0 / (to - from));
  if (!(t > T(0))) {
    return T(0);
  }
  if (!(t < T(1))) {
    return T(1);
  }
  return t * t * t * (T(10) + t * (T(6) * t - T(15)));
}

// (s(z) - s - s' dz) / dz^2 for the distance s(z) of a point from height z of an axis at distance
// rho, s and s' at the height `rise` above the point, dz further up. Does not cancel at dz = 0.
template <typename T>
T excess_curvature(const T& rho, const T& rise, const T& dz) {
  using std::sqrt;
  const T here = sqrt(rho * rho + rise * rise);
  const T there = sqrt(rho * rho + (rise + dz) * (rise + dz));
  const T both = here + there;
  return (here - rise * (rise + rise + dz) / both) / (here * both);
}

}  // namespace cylinder

template <typename T>
CylinderRoute<T> CylinderScatterer::route(const Vec3<T>& source, const Vec3<T>& observer) const {
  using std::atan2;
  using std::sqrt;
  CylinderRoute<T> route;
  const auto turned = [&](const Vec3<T>& p) {
    return Vec3<T>{
        T(cos_yaw_) * p.x + T(sin_yaw_) * p.y, T(cos_yaw_) * p.y - T(sin_yaw_) * p.x, p.z};
  };
  const Vec3<T> in = turned(source);
  const Vec3<T> out = turned(observer);
  route.rho_in = sqrt(in.x * in.x + in.y * in.y);
  route.rho_out = sqrt(out.x * out.x + out.y * out.y);
  route.phi_in = atan2(in.y, in.x);
  route.phi_out = atan2(out.y, out.x);
  // The support function of the ellipse in the direction between both ends: how much shorter the
  // way by the reflecting point is than by the axis, to first order of size over distance.
  const T bx = T(body_.semi_axes[0]) * (in.x / route.rho_in + out.x / route.rho_out);
  const T by = T(body_.semi_axes[1]) * (in.y / route.rho_in + out.y / route.rho_out);
  const double blur = cylinder::kBlur * (body_.semi_axes[0] + body_.semi_axes[1]);
  const T shorter = sqrt(bx * bx + by * by + T(blur * blur)) - T(blur);
  route.across = route.rho_in + route.rho_out - shorter;
  const T rise = out.z - in.z;
  route.length = sqrt(route.across * route.across + rise * rise);
  route.cos_elevation = route.across / route.length;
  route.sin_elevation = rise / route.length;
  route.height = in.z + rise * (route.rho_in - T(0.5) * shorter) / route.across;
  route.source_height = in.z;
  route.observer_height = out.z;
  return route;
}

template <typename T>
T CylinderScatterer::validity(const CylinderRoute<T>& route) const {
  const double reach = std::max(body_.semi_axes[0], body_.semi_axes[1]);
  const auto away = [&](const T& rho) {
    return cylinder::smooth_step(rho, cylinder::kTouching * reach, cylinder::kFree * reach);
  };
  return cylinder::smooth_step(route.cos_elevation, cylinder::kSteep, cylinder::kLevel) *
         away(route.rho_in) * away(route.rho_out);
}

// The share of the field from below height z. The detour by way of that height, in half waves, is
// u^2 / 2.
template <typename T>
Complex<T> CylinderScatterer::edge(const CylinderRoute<T>& route, double z) const {
  using std::sqrt;
  const T dz = T(z) - route.height;
  // To the surface, each its share of the horizontal way.
  const T share = route.across / (route.rho_in + route.rho_out);
  const T curvature =
      cylinder::excess_curvature<T>(share * route.rho_in, route.height - route.source_height, dz) +
      cylinder::excess_curvature<T>(
          share * route.rho_out, route.height - route.observer_height, dz);
  const T u = dz * sqrt(T(4.0 / wavelength_) * curvature);
  const Complex<double> value = knife_edge(value_of(u));
  const Complex<double> slope = knife_edge_slope(value_of(u));
  return {composed(u, value.re, slope.re), composed(u, value.im, slope.im)};
}

template <typename T>
Complex<T> CylinderScatterer::window(const CylinderRoute<T>& route) const {
  return edge(route, body_.base + body_.height) - edge(route, body_.base);
}

template <typename T>
CylinderScattering<T> CylinderScatterer::scatter(const CylinderRoute<T>& route) const {
  using std::sqrt;
  CylinderScattering<T> result;
  result.length = route.length;
  const T weight = validity(route);
  if (!(weight > T(0))) {
    return result;
  }
  const double k = 2.0 * std::numbers::pi / wavelength_;
  const T kt = T(k) * route.cos_elevation;
  const std::array<T, kSectionArguments> arguments{
      kt * route.rho_in, kt * route.rho_out, route.phi_in, route.phi_out, route.cos_elevation};
  const auto at = [&](std::size_t i) { return value_of(arguments[i]); };
  const SectionRays rays{at(0), at(1), at(2), at(3), at(4)};
  const SectionResponse response =
      std::is_floating_point_v<T> ? section_->value(rays) : section_->respond(rays);
  // Stationary phase: with R the length, pi cos sqrt(k / (2 pi R)) exp(-j pi / 4), and the phase of
  // the way taken off.
  const T size = weight * T(std::numbers::pi) * route.cos_elevation *
                 sqrt(T(k / (2.0 * std::numbers::pi)) / route.length);
  const Complex<T> phase = exp(Complex<T>{T(0), kt * route.across - T(std::numbers::pi / 4.0)});
  const Complex<T> scale = Complex<T>{size, T(0)} * phase * window(route);
  const auto part = [&](SectionPart which) {
    Complex<T> sum{T(response.value[which].re), T(response.value[which].im)};
    for (std::size_t i = 0; i < kSectionArguments; ++i) {
      const Complex<double>& slope = response.slope[i][which];
      sum = sum + Complex<T>{composed(arguments[i], 0.0, slope.re),
                             composed(arguments[i], 0.0, slope.im)};
    }
    return scale * sum;
  };
  const Complex<T> sine{route.sin_elevation, T(0)};
  result.vv = part(kVv);
  result.hh = part(kHh);
  result.vh = sine * part(kVh);
  result.hv = sine * part(kHv);
  return result;
}

}  // namespace rayloc
