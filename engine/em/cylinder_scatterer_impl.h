// The templates of cylinder_scatterer.h; include that.
#pragma once

#include <algorithm>
#include <type_traits>

#include "engine/base/dual.h"
#include "engine/base/smooth_step.h"
#include "engine/em/cylinder_scatterer.h"

namespace rayloc {
namespace cylinder {

// Waves whose cosine of elevation is below the first are left out, above the second kept in full.
inline constexpr double kSteep = 0.18;
inline constexpr double kLevel = 0.26;  // a cosine: 75 degrees; chosen, as is the first: 80
// The same for the distance of an end from the axis, in larger semi-axes.
inline constexpr double kTouching = 1.0;
inline constexpr double kFree = 1.05;  // a ratio, chosen: from here on the wave is kept in full
// In the shadow the path is the straight one, which the body's wave must cancel; in the light it
// is that by the reflecting point. Limits of the transition: distance of the straight path from
// the axis, in radii.
inline constexpr double kGrazing = 1.0;
inline constexpr double kLit = 1.5;  // a ratio, chosen: from here on the light is complete

// 0 below `from`, 1 above `to`.
template <typename T>
T step_between(const T& x, double from, double to) {
  return smooth_step<T>((x - T(from)) * T(1.0 / (to - from)));
}

// (s(z) - s - s' dz) / dz^2 for the distance s(z) of a point from height z of an axis at distance
// rho, s and s' at the height `rise` above the point, dz further up. No cancellation at dz = 0.
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
HorizontalPath<T> CylinderScatterer::horizontal_path(const Vec3<T>& in,
                                                     const Vec3<T>& out,
                                                     const T& rho_in,
                                                     const T& rho_out) const {
  using std::sqrt;
  const auto between = [](const T& x, const T& y) { return sqrt(x * x + y * y); };
  // The surface reflects from one direction to the other where it faces the middle of both.
  const T middle_x = in.x / rho_in + out.x / rho_out;
  const T middle_y = in.y / rho_in + out.y / rho_out;
  const T cosine2 = T(0.25) * (middle_x * middle_x + middle_y * middle_y);
  const T support = T(0.5) * between(T(body_.semi_axes[0]) * middle_x,
                                     T(body_.semi_axes[1]) * middle_y);  // times the cosine
  // Distance of the straight line from the axis there, in supports. Straight behind the body it is
  // 0 / 0, and no light.
  const T clearance = T(2) * rho_in * rho_out / (rho_in + rho_out) * cosine2 / support;
  const T light = cylinder::step_between(
      clearance + T(2) * cosine2 * cosine2, cylinder::kGrazing, cylinder::kLit);
  const T straight_share = rho_in / (rho_in + rho_out);
  if (!(light > T(0))) {
    return {between(in.x - out.x, in.y - out.y), straight_share};
  }
  const T px = T(0.5 * body_.semi_axes[0] * body_.semi_axes[0]) * middle_x / support;
  const T py = T(0.5 * body_.semi_axes[1] * body_.semi_axes[1]) * middle_y / support;
  const T to = between(in.x - px, in.y - py);
  const T from = between(out.x - px, out.y - py);
  HorizontalPath<T> reflected{to + from, to / (to + from)};
  if (!(light < T(1))) {
    return reflected;
  }
  const T straight = between(in.x - out.x, in.y - out.y);
  return {straight + light * (reflected.length - straight),
          straight_share + light * (reflected.share_in - straight_share)};
}

template <typename T>
CylinderRoute<T> CylinderScatterer::route(const Vec3<T>& source, const Vec3<T>& observer) const {
  using std::atan2;
  using std::sqrt;
  CylinderRoute<T> route;
  const auto rotated = [&](const Vec3<T>& p) {
    return Vec3<T>{
        T(cos_yaw_) * p.x + T(sin_yaw_) * p.y, T(cos_yaw_) * p.y - T(sin_yaw_) * p.x, p.z};
  };
  const Vec3<T> in = rotated(source);
  const Vec3<T> out = rotated(observer);
  route.rho_in = sqrt(in.x * in.x + in.y * in.y);
  route.rho_out = sqrt(out.x * out.x + out.y * out.y);
  route.phi_in = atan2(in.y, in.x);
  route.phi_out = atan2(out.y, out.x);
  const HorizontalPath<T> path = horizontal_path(in, out, route.rho_in, route.rho_out);
  route.across = path.length;
  const T rise = out.z - in.z;
  route.length = sqrt(route.across * route.across + rise * rise);
  route.cos_elevation = route.across / route.length;
  route.sin_elevation = rise / route.length;
  route.height = in.z + rise * path.share_in;
  route.source_height = in.z;
  route.observer_height = out.z;
  return route;
}

template <typename T>
T CylinderScatterer::validity(const CylinderRoute<T>& route) const {
  const double reach = std::max(body_.semi_axes[0], body_.semi_axes[1]);
  const auto away = [&](const T& rho) {
    return cylinder::step_between(rho, cylinder::kTouching * reach, cylinder::kFree * reach);
  };
  return cylinder::step_between(route.cos_elevation, cylinder::kSteep, cylinder::kLevel) *
         away(route.rho_in) * away(route.rho_out);
}

// The share of the field from below height z. The detour via that height, in half
// waves, is u^2 / 2.
template <typename T>
Complex<T> CylinderScatterer::edge(const CylinderRoute<T>& route, double z) const {
  using std::sqrt;
  const T dz = T(z) - route.height;
  // To the surface, each with its share of the horizontal path.
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
  // the path removed.
  const T size = weight * T(std::numbers::pi) * route.cos_elevation *
                 sqrt(T(k / (2.0 * std::numbers::pi)) / route.length);
  const Complex<T> phase = exp(Complex<T>{T(0), kt * route.across - T(std::numbers::pi / 4.0)});
  // Divided by the first terms of H_0(k_t across), so that a straight wave is preserved: without
  // them a thousandth of it remains in the shadow.
  const T near = T(0.125) / (kt * route.across);
  const Complex<T> hankel{T(1) - T(4.5) * near * near, near};
  const Complex<T> scale = Complex<T>{size, T(0)} * phase * window(route) / hankel;
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
