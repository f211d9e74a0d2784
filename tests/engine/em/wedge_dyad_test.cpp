#include "engine/em/wedge_dyad.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "engine/base/vec3.h"
#include "engine/em/slab.h"
#include "tests/support/gradient_check.h"

namespace rayloc::wedge_dyad_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWavelength = 0.0545;  // [m], 5.5 GHz

template <typename T>
struct Slab {
  Complex<T> relative_permittivity{T(5.24), T(-0.46)};
  T thickness{0.02};  // [m]

  SlabCoefficients<T> at(const T& cosine) const {
    return slab_coefficients<T>(cosine, relative_permittivity, thickness, T(kWavelength));
  }
  SlabTable::Pair<T> reflection(const T& cosine) const {
    return {at(cosine).r_te, at(cosine).r_excess};
  }
  SlabTable::Pair<T> transmission(const T& cosine) const {
    return {at(cosine).t_te, at(cosine).t_excess};
  }
};

struct Conductor {
  static SlabTable::Pair<double> reflection(double /*cosine*/) { return {{-1.0, 0.0}, {}}; }
  static SlabTable::Pair<double> transmission(double /*cosine*/) { return {}; }
};

void expect_near(const Complex<double>& found, const Complex<double>& expected, double error) {
  EXPECT_NEAR(found.re, expected.re, error);
  EXPECT_NEAR(found.im, expected.im, error);
}

void expect_near(const WedgeDyad<double>& found, const WedgeDyad<double>& expected, double error) {
  expect_near(found.ss, expected.ss, error);
  expect_near(found.sh, expected.sh, error);
  expect_near(found.hs, expected.hs, error);
  expect_near(found.hh, expected.hh, error);
}

WedgeDyad<double> dyad(double n, double from, double to, double cos_edge, WedgeBody body) {
  const Slab<double> face;
  return wedge_dyad<double>({n, from, to, 30.0}, cos_edge, face, face, body);
}

// A way's direction by its azimuth about the z axis.
Vec3d direction(double azimuth, double cos_edge) {
  const double across = std::sqrt(1.0 - cos_edge * cos_edge);
  return {across * std::cos(azimuth), across * std::sin(azimuth), cos_edge};
}

struct Field {
  Vec3d re, im;
};

// By its parts across and in the plane of incidence, as textbooks have it.
Field met(const Vec3d& field, const Vec3d& in, const Vec3d& normal, bool reflected) {
  const Vec3d out = reflected ? in - 2.0 * dot(in, normal) * normal : in;
  const Vec3d across = cross(in, normal);
  const Vec3d te = (1.0 / norm(across)) * across;
  const SlabCoefficients<double> slab = Slab<double>{}.at(std::abs(dot(in, normal)));
  const Complex<double> r_te = reflected ? slab.r_te : slab.t_te;
  const Complex<double> r_tm = reflected ? slab.r_tm : slab.t_tm;
  const double part_te = dot(field, te);
  const double part_tm = dot(field, cross(te, in));
  const Vec3d tm = cross(te, out);
  return {r_te.re * part_te * te + r_tm.re * part_tm * tm,
          r_te.im * part_te * te + r_tm.im * part_tm * tm};
}

Vec3d soft_of(const Vec3d& d) {
  const Vec3d edge{0.0, 0.0, 1.0};
  const Vec3d along = edge - dot(edge, d) * d;
  return (1.0 / norm(along)) * along;
}
Vec3d hard_of(const Vec3d& d) {
  const Vec3d across = cross(d, {0.0, 0.0, 1.0});
  return (1.0 / norm(across)) * across;
}

// A field that comes along `in` as a dyad of the edge makes it.
Field rotated(const WedgeDyad<double>& d, const Vec3d& field, const Vec3d& in, const Vec3d& out) {
  const double s = dot(field, soft_of(in));
  const double h = dot(field, hard_of(in));
  const Vec3d soft = soft_of(out);
  const Vec3d hard = hard_of(out);
  return {(d.ss.re * s + d.sh.re * h) * soft + (d.hs.re * s + d.hh.re * h) * hard,
          (d.ss.im * s + d.sh.im * h) * soft + (d.hs.im * s + d.hh.im * h) * hard};
}

// The jump of the dyad from the dark to the light side of a boundary, both 1e-9 from it.
WedgeDyad<double> jump(
    double n, double from, double dark, double lit, double cos_edge, WedgeBody body) {
  const Complex<double> minus{-1.0, 0.0};
  return dyad(n, from, dark, cos_edge, body) + minus * dyad(n, from, lit, cos_edge, body);
}

constexpr double kOff = 1e-9;

TEST(WedgeDyad, IsSoftAndHardForAConductor) {
  for (const double cos_edge : {0.0, 0.6}) {
    for (const double to : {0.3, 2.0, 4.4}) {
      const WedgeRay<double> ray{1.5, 0.8, to, 30.0};
      const WedgeDyad<double> found =
          wedge_dyad(ray, cos_edge, Conductor{}, Conductor{}, WedgeBody::kOpaque);
      const WedgeTerms<double> terms = wedge_terms(ray);
      expect_near(found, {soft(terms), {}, {}, hard(terms)}, 1e-13);
    }
  }
}

TEST(WedgeDyad, JumpsByTheReflectedWave) {
  for (const double cos_edge : {0.0, 0.4, -0.7}) {
    for (const double from : {0.5, 1.9}) {
      const double at = kPi - from;
      const Vec3d in = -direction(from, -cos_edge);
      const Vec3d out = direction(at, cos_edge);
      const Vec3d field = 0.8 * soft_of(in) - 0.5 * hard_of(in);
      const Field expected = met(field, in, {0.0, 1.0, 0.0}, true);
      for (const WedgeBody body : {WedgeBody::kOpaque, WedgeBody::kSolid, WedgeBody::kSheet}) {
        const double n = body == WedgeBody::kSheet ? 2.0 : 1.6;
        const Field found =
            rotated(jump(n, from, at + kOff, at - kOff, cos_edge, body), field, in, out);
        EXPECT_NEAR(norm(found.re - expected.re), 0.0, 1e-7) << from << " " << cos_edge;
        EXPECT_NEAR(norm(found.im - expected.im), 0.0, 1e-7) << from << " " << cos_edge;
      }
    }
  }
}

TEST(WedgeDyad, JumpsByTheReflectionAtTheOtherFace) {
  constexpr double kN = 1.6;
  constexpr double kCosEdge = 0.4;
  const double from = 1.4 * kPi;
  const double at = (2.0 * kN - 1.0) * kPi - from;
  const Vec3d in = -direction(from, -kCosEdge);
  const Vec3d field = 0.8 * soft_of(in) - 0.5 * hard_of(in);
  const Field expected = met(field, in, direction((kN - 0.5) * kPi, 0.0), true);
  const Field found = rotated(jump(kN, from, at - kOff, at + kOff, kCosEdge, WedgeBody::kSolid),
                              field,
                              in,
                              direction(at, kCosEdge));
  EXPECT_NEAR(norm(found.re - expected.re), 0.0, 1e-7);
  EXPECT_NEAR(norm(found.im - expected.im), 0.0, 1e-7);
}

TEST(WedgeDyad, JumpsByTheBlockedField) {
  constexpr double kCosEdge = 0.4;
  for (const bool is_sheet : {false, true}) {
    const double n = is_sheet ? 2.0 : 1.6;
    for (const double from : {0.4, 0.9, (n - 0.2) * kPi}) {
      const bool rising = from < kPi;
      const double at = rising ? from + kPi : from - kPi;
      const Vec3d heading = -direction(from, -kCosEdge);
      const Vec3d field = 0.8 * soft_of(heading) - 0.5 * hard_of(heading);
      const Vec3d normal_0{0.0, 1.0, 0.0};
      const Vec3d normal_n = direction((n - 0.5) * kPi, 0.0);
      const auto through = [&](const Field& f, const Vec3d& normal) {
        const Field re = met(f.re, heading, normal, false);
        const Field im = met(f.im, heading, normal, false);
        return Field{re.re - im.im, re.im + im.re};
      };
      Field passed = through({field, {}}, rising ? normal_0 : normal_n);
      if (!is_sheet) {
        passed = through(passed, rising ? normal_n : normal_0);
      }
      const double dark = rising ? at + kOff : at - kOff;
      const double lit = rising ? at - kOff : at + kOff;
      const Field found = rotated(
          jump(n, from, dark, lit, kCosEdge, is_sheet ? WedgeBody::kSheet : WedgeBody::kSolid),
          field,
          heading,
          heading);
      EXPECT_NEAR(norm(found.re - (field - passed.re)), 0.0, 1e-7) << is_sheet << " " << from;
      EXPECT_NEAR(norm(found.im + passed.im), 0.0, 1e-7) << is_sheet << " " << from;
    }
  }
}

TEST(WedgeDyad, EndsMayBeExchanged) {
  for (const WedgeBody body : {WedgeBody::kOpaque, WedgeBody::kSolid, WedgeBody::kSheet}) {
    const double n = body == WedgeBody::kSheet ? 2.0 : 1.5;
    for (const double from : {0.4, 2.3}) {
      for (const double to : {1.1, 3.9, 4.5}) {
        const WedgeDyad<double> there = dyad(n, from, to, 0.4, body);
        const WedgeDyad<double> back = dyad(n, to, from, -0.4, body);
        // d x e turns with the way; e - (e . d) d does not.
        const Complex<double> none{};
        expect_near(back, {there.ss, none - there.hs, none - there.sh, there.hh}, 1e-13);
      }
    }
  }
}

TEST(WedgeDyad, VanishesOnFaces) {
  for (const WedgeBody body : {WedgeBody::kOpaque, WedgeBody::kSolid, WedgeBody::kSheet}) {
    const double n = body == WedgeBody::kSheet ? 2.0 : 1.5;
    for (const double from : {0.7, 2.1, 4.0}) {
      expect_near(dyad(n, from, 0.0, 0.4, body), {}, 1e-12);
      expect_near(dyad(n, from, n * kPi, 0.4, body), {}, 1e-12);
    }
  }
}

TEST(WedgeDyad, VanishesForAThinFilm) {
  const Slab<double> film{{1.5, 0.0}, 1e-12};
  for (const double to : {0.9, 3.3, 4.2}) {
    expect_near(
        wedge_dyad<double>({1.5, 0.5, to, 30.0}, 0.4, film, film, WedgeBody::kSolid), {}, 1e-9);
    expect_near(
        wedge_dyad<double>({2.0, 0.5, to, 30.0}, 0.4, film, film, WedgeBody::kSheet), {}, 1e-9);
  }
}

TEST(WedgeDyad, DerivativesMatchCentralDifferences) {
  for (const WedgeBody body : {WedgeBody::kOpaque, WedgeBody::kSolid, WedgeBody::kSheet}) {
    const double n = body == WedgeBody::kSheet ? 2.0 : 1.5;
    for (const double to : {0.9, 3.3, 4.2}) {
      for (int part = 0; part < 8; ++part) {
        const auto f = [&](const auto& x) {
          using T = std::decay_t<decltype(x[0])>;
          const Slab<T> face{{x[4], x[5]}, x[6]};
          const WedgeDyad<T> d = wedge_dyad<T>({n, x[0], x[1], x[2]}, x[3], face, face, body);
          const std::array<Complex<T>, 4> parts{d.ss, d.sh, d.hs, d.hh};
          const Complex<T>& one = parts[static_cast<std::size_t>(part / 2)];
          return part % 2 == 0 ? one.re : one.im;
        };
        test::expect_gradient_matches<7>(f, {0.4, to, 30.0, 0.4, 5.24, -0.46, 0.02});
      }
    }
  }
}

}  // namespace
}  // namespace rayloc::wedge_dyad_test
