// CylinderSection: response of the cross-section of an infinite cylinder to one line source at one
// observer; the sum over the orders (circle) or pairs of orders (ellipse).
//
// In the frame of the cylinder: the axis is z, azimuths are counted from the first semi-axis. A
// line source with phase exp(-j k sin_elevation z) radiates H_0^(2)(k_t distance), k_t = k
// cos_elevation; the response is the field added at the observer, for E_z and eta_0 H_z.
//
// Quantities that depend on the cylinder alone are computed once, for elevations up to
// kLowestCosine; steeper ones use that elevation.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "engine/base/complex.h"
#include "engine/base/expected.h"

namespace rayloc {

inline constexpr double kLowestCosine = 0.15;  // of an elevation: 81 degrees
// Limit for the larger semi-axis times the wavenumber; 0.9 m at 5.2 GHz.
inline constexpr double kLargestSection = 100.0;

struct SectionRays {
  double kt_rho_in = 0.0;   // k_t times the distance of the source from the axis
  double kt_rho_out = 0.0;  // of the observer
  double phi_in = 0.0;      // [rad], azimuth of the source
  double phi_out = 0.0;     // of the observer
  double cos_elevation = 1.0;
};

// vh is E_z of eta_0 H_z; vh and hv are divided by sin_elevation, with which they change sign.
enum SectionPart : std::size_t { kVv, kHh, kVh, kHv };
inline constexpr std::size_t kSectionParts = 4;      // a count, of SectionPart
inline constexpr std::size_t kSectionArguments = 5;  // the members of SectionRays

struct SectionResponse {
  std::array<Complex<double>, kSectionParts> value{};
  // Derivatives by each argument, where requested.
  std::array<std::array<Complex<double>, kSectionParts>, kSectionArguments> slope{};
};

class CylinderSection {
 public:
  CylinderSection() = default;
  CylinderSection(const CylinderSection&) = delete;
  CylinderSection& operator=(const CylinderSection&) = delete;
  virtual ~CylinderSection() = default;

  // REQUIRES: both distances are larger than the larger semi-axis.
  SectionResponse respond(const SectionRays& rays) const { return compute(rays, true); }
  // The same without derivatives.
  SectionResponse value(const SectionRays& rays) const { return compute(rays, false); }

 private:
  virtual SectionResponse compute(const SectionRays& rays, bool slopes) const = 0;
};

// k_radius, k_semi_axes: times the wavenumber of free space.
// REQUIRES: 0 < k_radius <= kLargestSection; Im relative_permittivity <= 0, Re >= 1.
std::unique_ptr<const CylinderSection> make_circular_section(
    double k_radius, const Complex<double>& relative_permittivity);
// An Error when the body is too large, flat and transparent for double precision.
Expected<std::unique_ptr<const CylinderSection>> make_elliptic_section(
    const std::array<double, 2>& k_semi_axes, const Complex<double>& relative_permittivity);

}  // namespace rayloc
