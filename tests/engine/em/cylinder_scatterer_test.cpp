// Against tests/data/goldens/cylinder (the integral over k_z, SciPy), and against physics.
#include "engine/em/cylinder_scatterer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <ceres/jet.h>

#include "engine/base/constants.h"
#include "engine/em/cylinder_bessel.h"
#include "engine/em/radio_material.h"
#include "tests/support/golden.h"

namespace rayloc::cylinder_scatterer_test {
namespace {

using nlohmann::json;
using Value = std::complex<double>;
using Jet = ceres::Jet<double, 2>;

constexpr double kCarrier = 5.18e9;  // [Hz]
constexpr double kWavelength = kSpeedOfLight / kCarrier;
constexpr double kWavenumber = 2.0 * std::numbers::pi / kWavelength;

Value value(const Complex<double>& z) { return {z.re, z.im}; }
Value value(const Complex<Jet>& z) { return {z.re.a, z.im.a}; }
double degrees(double angle) { return angle * std::numbers::pi / 180.0; }
double decibel(const Value& z) { return 20.0 * std::log10(std::abs(z)); }

Complex<double> material(double eps_r, double sigma) {
  return complex_permittivity({"body", eps_r, sigma}, kCarrier);
}

// So tall that its ends do nothing.
CylinderBody tall(double radius, const Complex<double>& permittivity) {
  return {{radius, radius}, 0.0, -1e4, 2e4, permittivity};
}
CylinderBody person() { return {{0.2, 0.2}, 0.0, 0.0, 1.75, material(36.0, 4.0)}; }

CylinderScatterer scatterer(const CylinderBody& body) {
  auto created = CylinderScatterer::create(body, kWavelength);
  if (!created) {
    ADD_FAILURE() << created.error().message;
    std::abort();
  }
  return *created;
}

Value spherical(double distance) { return std::polar(1.0 / distance, -kWavenumber * distance); }

// Response of a vertical observer to a vertical unit field; positions relative to the axis.
Value vertical(const CylinderScatterer& body, const Vec3d& source, const Vec3d& observer) {
  const auto scattering = body.scatter(body.route(source, observer));
  return value(scattering.vv) * std::polar(1.0, -kWavenumber * scattering.length);
}

// A dipole's field along z, its near terms included, over exp(-jkR) / R.
Value dipole(double distance, double sine) {
  const double kr = kWavenumber * distance;
  const double sine2 = sine * sine;
  return 1.0 - sine2 + (3.0 * sine2 - 1.0) * Value{1.0 / (kr * kr), 1.0 / kr};
}

struct Errors {
  double light_decibel = 0.0;
  double light_degree = 0.0;
  double shadow_decibel = 0.0;
  double cross = 0.0;  // of the direct wave: what is rotated into the other polarisation
};

// Compares the total fields beside one body, E_z of an electric dipole (vertical polarisation) and
// H_z of a magnetic one (horizontal), for each angle between source and observer.
void compare(const json& c, Errors& errors) {
  // In the deepest shadow, what is left of the direct wave.
  constexpr double kRest = 1e-3;
  const double radius = c.at("k_radius").get<double>() / kWavenumber;
  const double rho_s = c.at("rho_s");
  const double rho_o = c.at("rho_o");
  const CylinderScatterer body = scatterer(tall(radius, material(c.at("eps_r"), c.at("sigma"))));
  const double edge = std::acos(radius / rho_s) + std::acos(radius / rho_o);
  for (const json& row : c.at("rows")) {
    const auto column = [&](std::size_t i) { return Value{row.at(i), row.at(i + 1)}; };
    const double phi = degrees(row.at(0));
    const auto route = body.route<double>(
        {rho_s, 0.0, 0.0}, {rho_o * std::cos(phi), rho_o * std::sin(phi), c.at("rise")});
    const CylinderScattering<double> scattering = body.scatter(route);
    const Value scale = dipole(route.length, route.sin_elevation) *
                        std::polar(1.0, -kWavenumber * scattering.length);
    const Value direct = column(1);
    for (const auto& [part, added] :
         {std::pair{scattering.vv, column(3)}, {scattering.hh, column(5)}}) {
      const Value exact = direct + added;
      const Value error = scale * value(part) - added;
      const double level = std::abs(decibel(1.0 + error / exact));
      if (phi <= edge) {
        errors.light_decibel = std::max(errors.light_decibel, level);
        errors.light_degree = std::max(
            errors.light_degree, std::abs(std::arg(1.0 + error / exact)) * 180 / std::numbers::pi);
      } else if (std::abs(error) > kRest * std::abs(direct)) {
        errors.shadow_decibel = std::max(errors.shadow_decibel, level);
      }
    }
    errors.cross = std::max(errors.cross,
                            std::abs(scale * value(scattering.vh) - column(7)) / std::abs(direct));
  }
}

TEST(CylinderScatterer, TotalFieldOfADipoleMatchesTheIntegral) {
  const json doc = test::golden("cylinder/point_source");
  ASSERT_EQ(doc.at("frequency"), kCarrier);
  Errors skin;
  Errors wood;
  Errors steep_wood;  // beside a body that waves go through, from nearby
  for (const json& c : doc.at("cases")) {
    const double rise = c.at("rise");
    const double rho_s = c.at("rho_s");
    const bool steep = std::abs(rise) > 0.5 * (rho_s + c.at("rho_o").get<double>());
    compare(c, c.at("material") == "skin" ? skin : steep ? steep_wood : wood);
  }
  for (const auto& [name, errors] :
       {std::pair{"skin", skin}, {"wood", wood}, {"steep_wood", steep_wood}}) {
    RecordProperty(name,
                   std::to_string(errors.light_decibel) + " " +
                       std::to_string(errors.light_degree) + " " +
                       std::to_string(errors.shadow_decibel) + " " + std::to_string(errors.cross));
  }
  // Asked for: 1 dB and 15 degrees in the light, 3 dB in the shadow.
  EXPECT_LT(skin.light_decibel, 0.25);
  EXPECT_LT(skin.light_degree, 1.0);
  EXPECT_LT(skin.shadow_decibel, 3.0);
  EXPECT_LT(skin.cross, 0.02);
  EXPECT_LT(wood.light_decibel, 0.2);
  EXPECT_LT(wood.light_degree, 1.0);
  EXPECT_LT(wood.shadow_decibel, 1.2);
  EXPECT_LT(wood.cross, 0.02);
  // Waves that turn around inside have an elevation of their own.
  EXPECT_LT(steep_wood.light_decibel, 3.0);
  EXPECT_LT(steep_wood.light_degree, 15.5);
  EXPECT_LT(steep_wood.shadow_decibel, 3.3);
}

TEST(CylinderScatterer, ShadowOfAPointSourceIsThatOfALineSource) {
  const double rho_s = 2.0;
  const double rho_o = 1.5;
  const double radius = 0.2;
  const auto section = make_circular_section(kWavenumber * radius, material(36.0, 4.0));
  const CylinderScatterer body = scatterer(tall(radius, material(36.0, 4.0)));
  for (double angle : {150.0, 165.0, 172.0, 177.0, 180.0}) {
    const double phi = degrees(angle);
    const double distance =
        std::sqrt(rho_s * rho_s + rho_o * rho_o - 2.0 * rho_s * rho_o * std::cos(phi));
    std::array<Complex<double>, 2> direct;
    hankel_orders(kWavenumber * distance, direct);
    const Value line =
        1.0 + value(section->respond({kWavenumber * rho_s, kWavenumber * rho_o, 0.0, phi, 1.0})
                        .value[kVv]) /
                  value(direct[0]);
    const Value point =
        1.0 +
        vertical(body, {rho_s, 0.0, 1.0}, {rho_o * std::cos(phi), rho_o * std::sin(phi), 1.0}) /
            spherical(distance);
    EXPECT_LT(std::abs(point - line), 0.02) << angle;
  }
}

TEST(CylinderScatterer, IsReciprocal) {
  CylinderBody oval = person();
  oval.semi_axes = {0.22, 0.14};
  oval.yaw = 0.5;
  for (const CylinderBody& body : {person(), oval}) {
    const CylinderScatterer s = scatterer(body);
    const Vec3d p{1.2, -0.8, 2.2};
    const Vec3d q{-0.9, 1.5, 0.9};
    const auto forth = s.scatter(s.route(p, q));
    const auto back = s.scatter(s.route(q, p));
    EXPECT_EQ(forth.length, back.length);
    const double size = std::abs(value(forth.vv));
    EXPECT_NEAR(std::abs(value(forth.vv) - value(back.vv)), 0.0, 1e-9 * size);
    EXPECT_NEAR(std::abs(value(forth.hh) - value(back.hh)), 0.0, 1e-9 * size);
    // The wave travels the other way, so its h points the other way.
    EXPECT_NEAR(std::abs(value(forth.vh) + value(back.hv)), 0.0, 1e-9 * size);
    EXPECT_GT(std::abs(value(forth.vh)), 1e-3 * size);
  }
}

TEST(CylinderScatterer, TopIsAKnifeEdge) {
  // So wide that little comes around its sides.
  CylinderBody body{{0.9, 0.9}, 0.0, -1e4, 1e4 + 2.0, material(36.0, 4.0)};
  const CylinderScatterer s = scatterer(body);
  const double distance = 4.0;
  for (const double below : {-0.6, -0.2, 0.0, 0.1, 0.2}) {
    const Vec3d source{distance, 0.0, 2.0 - below};
    const Vec3d observer{-distance, 0.0, 2.0 - below};
    const double loss = decibel(1.0 + vertical(s, source, observer) / spherical(2.0 * distance));
    // [P.526] (31) is an approximation of the loss of a knife edge, for nu > -0.78, to 0.1 dB.
    const double nu = below * std::sqrt(2.0 / kWavelength * 2.0 / distance);
    if (nu > -0.78) {
      const double approximation =
          6.9 + 20.0 * std::log10(std::sqrt((nu - 0.1) * (nu - 0.1) + 1.0) + nu - 0.1);
      EXPECT_NEAR(-loss, approximation, 0.6) << below;
    } else {
      EXPECT_NEAR(loss, 0.0, 1.0) << below;
    }
  }
}

TEST(CylinderScatterer, BodyOnAMirrorIsHalfOfOneTwiceAsTall) {
  CylinderBody body = person();
  const CylinderScatterer half = scatterer(body);
  body.base = -body.height;
  body.height *= 2.0;
  const CylinderScatterer whole = scatterer(body);
  // Over a perfect mirror at z = 0, both ends' images belong to the lower half.
  const Vec3d source{1.4, 0.3, 0.2};
  const Vec3d observer{-1.1, 0.2, 0.05};
  const auto image = [](const Vec3d& p) { return Vec3d{p.x, p.y, -p.z}; };
  const Value sum =
      vertical(half, source, observer) + vertical(half, image(source), image(observer));
  const Value want = vertical(whole, source, observer);
  EXPECT_NEAR(std::abs(sum - want), 0.0, 1e-9 * std::abs(want));
  EXPECT_GT(std::abs(vertical(half, image(source), image(observer))), 0.05 * std::abs(want));
}

TEST(CylinderScatterer, TotalFieldIsContinuousAcrossTheShadowBoundary) {
  const CylinderScatterer body = scatterer(person());
  const Vec3d source{2.0, 0.0, 1.2};
  Value last;
  for (int i = 0; i <= 4000; ++i) {
    // The observer walks across the shadow and the light on both sides, half a millimetre a step.
    const Vec3d observer{-1.5, -1.0 + 5e-4 * i, 1.0};
    const double distance = norm(observer - source);
    const Value total = vertical(body, source, observer) + spherical(distance);
    if (i > 0) {
      // The phase turns by 0.05 at the most.
      EXPECT_LT(std::abs(total - last), 0.08 / distance) << i;
    }
    last = total;
  }
}

TEST(CylinderScatterer, DerivativesByThePositionMatchCentralDifferences) {
  constexpr double kStep = 1e-6;
  CylinderBody oval = person();
  oval.semi_axes = {0.22, 0.14};
  oval.yaw = 0.5;
  const Vec3d source{2.0, 0.4, 2.4};
  const Vec3d observer{-1.6, -0.3, 0.9};
  // In the shadow, at its edge, in the light, beside it, behind the source, near it.
  constexpr std::array<std::array<double, 2>, 6> kPlaces{
      {{0.1, 0.05}, {0.0, 0.25}, {0.3, -0.7}, {0.2, 1.5}, {2.9, 0.2}, {1.4, 0.3}}};
  for (const CylinderBody& shape : {person(), oval}) {
    const CylinderScatterer body = scatterer(shape);
    for (const std::array<double, 2>& place : kPlaces) {
      const double x = place[0];
      const double y = place[1];
      const auto at = [&]<typename T>(const T& px, const T& py) {
        const auto relative = [&](const Vec3d& p) {
          return Vec3<T>{T(p.x) - px, T(p.y) - py, T(p.z)};
        };
        return body.scatter(body.route<T>(relative(source), relative(observer)));
      };
      const auto dual = at(Jet(x, 0), Jet(y, 1));
      for (int i = 0; i < 2; ++i) {
        const double dx = i == 0 ? kStep : 0.0;
        const double dy = i == 1 ? kStep : 0.0;
        const auto high = at(x + dx, y + dy);
        const auto low = at(x - dx, y - dy);
        const auto expect_slope = [&](Complex<double> above,
                                      Complex<double> below,
                                      Complex<Jet> z) {
          const Value slope = (value(above) - value(below)) / (2.0 * kStep);
          const double size = std::abs(slope) + std::abs(value(dual.vv)) + std::abs(value(dual.hh));
          EXPECT_NEAR(z.re.v[i], slope.real(), 1e-6 * size) << x << " " << y << " by " << i;
          EXPECT_NEAR(z.im.v[i], slope.imag(), 1e-6 * size) << x << " " << y << " by " << i;
        };
        expect_slope(high.vv, low.vv, dual.vv);
        expect_slope(high.hh, low.hh, dual.hh);
        expect_slope(high.vh, low.vh, dual.vh);
        expect_slope(high.hv, low.hv, dual.hv);
        EXPECT_NEAR(dual.length.v[i], (high.length - low.length) / (2.0 * kStep), 1e-8);
      }
    }
  }
}

TEST(CylinderScatterer, ThinBodyDoesNothing) {
  const CylinderScatterer body = scatterer(tall(1e-4, material(36.0, 4.0)));
  const Vec3d source{1.0, 0.2, 1.0};
  const Vec3d observer{-1.0, 0.1, 1.5};
  EXPECT_LT(std::abs(vertical(body, source, observer)),
            0.02 * std::abs(spherical(norm(source - observer))));
  // A dielectric, less than a conductor: the logarithm of its radius does not count.
  const CylinderScatterer thread = scatterer(tall(1e-4, material(3.0, 0.0)));
  EXPECT_LT(std::abs(vertical(thread, source, observer)), 1e-3);
}

TEST(CylinderScatterer, OmitsDirectionsOutsideItsTheory) {
  const CylinderScatterer body = scatterer(person());
  // Above the body's head; and so steep that it is as good as above.
  EXPECT_EQ(std::abs(vertical(body, {0.1, 0.0, 2.4}, {1.0, 0.0, 1.0})), 0.0);
  EXPECT_EQ(std::abs(vertical(body, {0.3, 0.0, 4.0}, {0.3, 0.1, 0.2})), 0.0);
  EXPECT_TRUE(body.contains({0.1, 0.1, 1.0}));
  EXPECT_FALSE(body.contains({0.1, 0.1, 1.8}));
  EXPECT_FALSE(body.contains({0.15, 0.15, 1.0}));
}

TEST(CylinderScatterer, RefusesBodiesThatCannotBe) {
  const auto message = [](auto change) {
    CylinderBody body = person();
    change(body);
    const auto created = CylinderScatterer::create(body, kWavelength);
    return created ? std::string("accepted") : created.error().message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using B = CylinderBody;
  EXPECT_EQ(message([](B& b) {
              b.semi_axes = {0.0, 0.0};
            }),
            "body: a semi-axis is 0, must be more than 0 and at most 0.921109 m");
  EXPECT_EQ(message([](B& b) { b.semi_axes[1] = -0.1; }),
            "body: a semi-axis is -0.1, must be more than 0 and at most 0.921109 m");
  EXPECT_EQ(message([](B& b) {
              b.semi_axes = {2.0, 2.0};
            }),
            "body: a semi-axis is 2, must be more than 0 and at most 0.921109 m");
  EXPECT_EQ(message([&](B& b) { b.semi_axes[0] = nan; }),
            "body: a semi-axis is nan, must be more than 0 and at most 0.921109 m");
  EXPECT_EQ(message([](B& b) {
              b.semi_axes = {0.4, 0.1};
            }),
            "body: the ratio of the semi-axes is 4, must be at most 3");
  EXPECT_EQ(message([](B& b) { b.height = 0.0; }), "body: height is 0, must be more than 0 [m]");
  EXPECT_EQ(message([&](B& b) { b.base = nan; }), "body: base is nan, must be finite [m]");
  EXPECT_EQ(message([&](B& b) { b.yaw = nan; }), "body: yaw is nan, must be finite [rad]");
  EXPECT_EQ(message([](B& b) {
              b.relative_permittivity = {0.5, 0.0};
            }),
            "body: the relative permittivity is 0.5, must be between 1 and 200");
  EXPECT_EQ(message([](B& b) {
              b.relative_permittivity = {4.0, 1.0};
            }),
            "body: the imaginary part of the relative permittivity is 1, must be 0 or less: "
            "conductivity is 0 or more");
}

}  // namespace
}  // namespace rayloc::cylinder_scatterer_test
