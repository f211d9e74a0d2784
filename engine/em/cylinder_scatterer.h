// CylinderScatterer: contribution of an upright elliptic cylinder to the field of a point source.
//
// Two-dimensional solution (cylinder_section.h), extended to three dimensions. The point source is
// a superposition of line sources exp(-j k_z z) whose phases agree around one k_z, that of the
// wave's elevation: the sum over k_z then turns 2-D into spherical spreading and H_n(k rho) into
// H_n(k_t rho), k_t = k cos(elevation). The contribution contains the shadow (where it cancels the
// direct wave), the diffraction around the body and its reflection with the divergence of the
// curved surface, and is smooth across the shadow boundary.
//
// The height is finite: the part that its ends cut off is that of two knife edges
// (cylinder_window.h). Waves steeper than 75 to 80 degrees, and ends closer to the axis than the
// larger semi-axis (to 1.05 of it), are faded out: the theory does not cover them.
//
// Written in a scalar T for derivatives by the positions. The body's size and material have no
// derivative: they are plain doubles of create().
//
// Reference: [F] Felsen, Marcuvitz, Radiation and scattering of waves (1973), 5.4 (stationary phase
// of the k_z integral). Checked against the integral itself for v and h, ends 0.5 to 5 m from the
// axis (tests/data/goldens/cylinder): within 0.2 dB and 1 degree in the light and 1.5 dB in the
// shadow. Exception: waves reflected inside a body, whose elevation differs: up to 3 dB and 15
// degrees past wood, when both ends are as near and the path steeper than 30 degrees.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "engine/base/complex.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/em/cylinder_section.h"
#include "engine/em/cylinder_window.h"

namespace rayloc {

struct CylinderBody {
  std::array<double, 2> semi_axes{0.2, 0.2};  // [m]; equal: a circle of that radius
  double yaw = 0.0;                           // [rad], of the first semi-axis from +x
  double base = 0.0;                          // [m], z of the lower end
  double height = 1.75;                       // [m]
  Complex<double> relative_permittivity;      // Im <= 0; complex_permittivity()
};

// Geometry of a wave from `source` via the body to `observer`. Positions are relative to the
// axis in x and y.
template <typename T>
struct CylinderRoute {
  T rho_in{}, rho_out{};                 // [m], horizontally from the axis
  T phi_in{}, phi_out{};                 // [rad], azimuths in the body's frame
  T across{};                            // [m], horizontal length: straight in the shadow, by the
                                         // reflecting point in the light, blended between
  T length{};                            // [m], including the rise
  T cos_elevation{}, sin_elevation{};    // of the wave's travel; above the horizon: positive
  T height{};                            // [m], z where it meets the body
  T source_height{}, observer_height{};  // [m], their z
};

template <typename T>
struct HorizontalPath {
  T length{};    // [m], CylinderRoute::across
  T share_in{};  // part of it before the body
};

// E at the observer, in the directions v (upright, in the plane of the axis and the direction of
// travel) and h (phi^ of that direction), for a source whose field at a distance R is E exp(-jkR) /
// R. To be multiplied by exp(-jk length).
template <typename T>
struct CylinderScattering {
  Complex<T> vv, vh, hv, hh;  // [1/m]; vh: v of h
  T length{};                 // [m]
};

class CylinderScatterer {
 public:
  // An Error that names the invalid value. Takes a millisecond for a circle, half a
  // second for an ellipse.
  static Expected<CylinderScatterer> create(const CylinderBody& body, double wavelength);

  const CylinderBody& body() const { return body_; }
  double wavelength() const { return wavelength_; }  // [m]
  // True if a point, relative to the axis in x and y, is inside the body.
  bool contains(const Vec3d& point) const;

  // REQUIRES: neither is on the axis.
  template <typename T>
  CylinderRoute<T> route(const Vec3<T>& source, const Vec3<T>& observer) const;

  // Between 0 and 1: 0 where scatter() returns no field because the theory does not apply.
  template <typename T>
  T validity(const CylinderRoute<T>& route) const;

  template <typename T>
  CylinderScattering<T> scatter(const CylinderRoute<T>& route) const;

 private:
  CylinderScatterer(const CylinderBody& body,
                    double wavelength,
                    std::shared_ptr<const CylinderSection> section);

  template <typename T>
  HorizontalPath<T> horizontal_path(const Vec3<T>& in,
                                    const Vec3<T>& out,
                                    const T& rho_in,
                                    const T& rho_out) const;
  template <typename T>
  Complex<T> window(const CylinderRoute<T>& route) const;
  template <typename T>
  Complex<T> edge(const CylinderRoute<T>& route, double z) const;

  CylinderBody body_;
  double wavelength_;
  double cos_yaw_, sin_yaw_;
  std::shared_ptr<const CylinderSection> section_;
};

}  // namespace rayloc

#include "engine/em/cylinder_scatterer_impl.h"
