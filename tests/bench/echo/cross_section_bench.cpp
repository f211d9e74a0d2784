// Prints the bistatic radar cross-section of the model of a person, beside that of a human in
// 3GPP TR 38.901 (mean -1.37 dBsm). No input.
//
//   cross_section_bench
//
// The scattered field of a source exp(-jkR) / R at the distances d1 and d2 of both ends is
// E = sqrt(sigma / (4 pi)) / (d1 d2), and CylinderScattering is E, so
//
//   sigma = 4 pi |E|^2 (d1 d2)^2
//
// Within 2 L^2 / wavelength (100 m at 5.2 GHz) a body of height L is not in the far field: the ends
// receive a Fresnel zone of it only, and sigma is that of a point that scatters as much. Ends are
// at the height of the body's middle. `angle` is 0 straight back and 180 straight on; the mean is
// over the angles 0 to 150, outside the forward lobe. The last lines compare with closed forms of
// physical optics. The exit status is 1 if these differ by more than 1.5 dB.
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>

#include "engine/person/person_reference.h"
#include "engine/trace/scattering/target_body.h"

namespace rayloc::bench {
namespace {

constexpr std::array<double, 2> kCarriers = {2.44e9, 5.2e9};             // [Hz]
constexpr std::array<double, 5> kDistances = {1.0, 2.0, 3.0, 5.0, 1e4};  // [m]; the last: far field
constexpr int kMeanLimit = 150;                                          // [degree]
constexpr double kHuman = -1.37;                                         // [dBsm], 3GPP TR 38.901
// [dB], from physical optics, which lacks the penumbra: 1 dB at k a = 8.
constexpr double kMaxError = 1.5;

double decibel(double power) { return 10.0 * std::log10(power); }

struct Section {
  double v = 0.0;  // [m^2], of vertical polarization
  double h = 0.0;
};

Section section_at(const CylinderScatterer& body, double distance, double angle) {
  const double z = body.body().base + 0.5 * body.body().height;
  const double phi = angle * std::numbers::pi / 180.0;
  const Vec3d source{distance, 0.0, z};
  const Vec3d observer{distance * std::cos(phi), distance * std::sin(phi), z};
  const CylinderScattering<double> field = body.scatter(body.route(source, observer));
  const double spread = 4.0 * std::numbers::pi * std::pow(distance, 4);
  return {spread * (field.vv.re * field.vv.re + field.vv.im * field.vv.im),
          spread * (field.hh.re * field.hh.re + field.hh.im * field.hh.im)};
}

struct Means {
  Section power;    // [m^2]
  Section decibel;  // [dBsm]
};

Means mean_of(const CylinderScatterer& body, double distance) {
  Means means;
  const double weight = 1.0 / (kMeanLimit + 1);
  for (int angle = 0; angle <= kMeanLimit; ++angle) {
    const Section here = section_at(body, distance, angle);
    means.power.v += weight * here.v;
    means.power.h += weight * here.h;
    means.decibel.v += weight * decibel(here.v);
    means.decibel.h += weight * decibel(here.h);
  }
  return means;
}

void print_row(const CylinderScatterer& body, double distance) {
  const Means means = mean_of(body, distance);
  std::printf("%7.0f m", distance);
  for (const double angle : {0.0, 60.0, 90.0, 120.0, 150.0, 180.0}) {
    const Section here = section_at(body, distance, angle);
    std::printf(" %6.1f/%5.1f", decibel(here.v), decibel(here.h));
  }
  std::printf("  mean %5.1f/%5.1f, of dB %5.1f/%5.1f; v %+.1f dB from the human\n",
              decibel(means.power.v),
              decibel(means.power.h),
              means.decibel.v,
              means.decibel.h,
              decibel(means.power.v) - kHuman);
}

// Physical optics in the far field: straight back k a L^2 |R|^2, straight on that of the shadow.
bool is_physical(const CylinderScatterer& body, double carrier) {
  const CylinderBody& shape = body.body();
  const double radius = shape.semi_axes[0];
  const double k = 2.0 * std::numbers::pi / body.wavelength();
  const std::complex<double> n = std::sqrt(
      std::complex<double>(shape.relative_permittivity.re, shape.relative_permittivity.im));
  const double back = k * radius * shape.height * shape.height * std::norm((1.0 - n) / (1.0 + n));
  const double shadow = 2.0 * radius * shape.height;
  const double on =
      4.0 * std::numbers::pi * shadow * shadow / (body.wavelength() * body.wavelength());
  const double back_error = decibel(section_at(body, kDistances.back(), 0.0).v / back);
  const double on_error = decibel(section_at(body, kDistances.back(), 180.0).v / on);
  std::printf(
      "%.2f GHz, far field against physical optics: straight back %+.2f dB of %.1f dBsm, straight "
      "on %+.2f dB of %.1f dBsm\n",
      1e-9 * carrier,
      back_error,
      decibel(back),
      on_error,
      decibel(on));
  return std::abs(back_error) < kMaxError && std::abs(on_error) < kMaxError;
}

int print_all() {
  bool is_good = true;
  const TargetBody person = PersonModel{}.body;
  for (const double carrier : kCarriers) {
    const auto body = make_scatterer(person, carrier);
    if (!body) {
      std::fprintf(stderr, "%s\n", body.error().message.c_str());
      return 1;
    }
    std::printf(
        "%.2f GHz, radius %.3f m, height %.2f m, both ends at the distance; dBsm v/h at the "
        "angles 0, 60, 90, 120, 150, 180\n",
        1e-9 * carrier,
        person.semi_axes[0],
        person.height);
    for (const double distance : kDistances) {
      print_row(*body, distance);
    }
    is_good = is_physical(*body, carrier) && is_good;
  }
  for (const double scale : {1.0, 0.89, 0.85}) {
    std::printf("echo factor %.2f: %+.1f dB to each\n", scale, 2.0 * decibel(scale));
  }
  return is_good ? 0 : 1;
}

}  // namespace
}  // namespace rayloc::bench

int main() { return rayloc::bench::print_all(); }
