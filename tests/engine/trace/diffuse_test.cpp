// Diffuse scattering: against a plain integration, its balance, the exchange of ends, derivatives,
// and realisations whose mean it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/constants.h"
#include "engine/trace/diffuse/diffuse_field.h"
#include "engine/trace/diffuse/diffuse_tracer.h"
#include "engine/trace/link_change.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/scenes.h"

namespace rayloc::diffuse_test {
namespace {

using Kind = Parameter::Kind;

constexpr double kWavelength = kSpeedOfLight / test::kCarrier;  // [m]
constexpr double kPi = std::numbers::pi;

double decibels(double ratio) { return 10.0 * std::log10(ratio); }

RadioMaterial rough(RadioMaterial material, const SurfaceScattering& scattering) {
  material.scattering = scattering;
  return material;
}
const RadioMaterial kMetal{"metal", 1.0, 1e7, 0.002};
const SurfaceScattering kLambertian{0.4, 0.0, ScatteringPattern::kLambertian};
const SurfaceScattering kBackscattering{
    0.5, 0.2, ScatteringPattern::kBackscattering, 4.0, 8.0, 0.6};

// A room of 4 x 3 x 2.5 m, a body in it, and a sheet with a free edge.
std::shared_ptr<const Scene> room(const RadioMaterial& material) {
  return test::make_scene({{"room", test::box_mesh({0, 0, 0}, {4, 3, 2.5})},
                           {"body", test::box_mesh({1.5, 1.2, 0}, {2.1, 1.7, 1.1})},
                           {"sheet", test::rectangle_mesh({2.6, 0.4, 0.5}, {0, 1, 0}, {0, 0, 1})}},
                          material);
}

Transmitter transmitter_in_room() {
  Transmitter transmitter;
  transmitter.position = {0.7, 0.9, 1.3};
  transmitter.orientation = {0.3, -0.2, 0.4};
  transmitter.pattern = AntennaPattern::kHalfWaveDipole;
  return transmitter;
}

Receiver receiver_in_room() {
  Receiver receiver;
  receiver.position = {3.2, 2.1, 1.6};
  receiver.orientation = {-0.5, 0.1, 0.2};
  receiver.pattern = AntennaPattern::kDipole;
  return receiver;
}

TEST(Diffuse, SmoothSurfacesAreTracedAsEver) {
  const auto smooth = room(test::kConcrete);
  const auto coarse = room(rough(test::kConcrete, kBackscattering));
  const auto trace = [](const std::shared_ptr<const Scene>& scene, bool diffuse) {
    return PathTracer(scene, {.max_depth = 3, .transmission = true, .diffuse = diffuse})
        .trace(transmitter_in_room(), receiver_in_room());
  };
  const Paths before = trace(smooth, false);
  const Paths scattering = trace(coarse, true);
  const double factor = std::sqrt(1.0 - 0.25);
  ASSERT_GT(before.size(), 10U);
  for (const Paths& same : {trace(smooth, true), trace(coarse, false)}) {
    ASSERT_EQ(same.size(), before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(same[i].a.re, before[i].a.re);
      EXPECT_EQ(same[i].a.im, before[i].a.im);
    }
  }
  ASSERT_EQ(scattering.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const auto& met = before[i].interactions;
    const auto mirrors = std::count_if(
        met.begin(), met.end(), [](const Interaction& each) { return is_mirror(each.kind); });
    const double left = std::pow(factor, static_cast<double>(mirrors));
    EXPECT_NEAR(scattering[i].a.re, left * before[i].a.re, 1e-15);
    EXPECT_NEAR(scattering[i].a.im, left * before[i].a.im, 1e-15);
  }
  EXPECT_TRUE(DiffuseTracer(smooth, {})
                  .density(transmitter_in_room(), receiver_in_room())
                  .echoes()
                  .empty());
}

// The ends of what may be stated: all is scattered, and what there is reflects nothing.
TEST(Diffuse, EndsOfTheRangeAreNumbers) {
  SurfaceScattering all = kLambertian;
  all.scattering_coefficient = 1.0;
  const auto scene = room(rough(test::kConcrete, all));
  const PathTracer tracer(scene, {.max_depth = 2, .diffuse = true});
  const Transmitter from = transmitter_in_room();
  const ReceiverTracer at = tracer.at(receiver_in_room());
  const Paths paths = at.trace(from);
  const OfdmGrid carrier{test::kCarrier, 0.0, {0}};
  const auto derivatives = at.differentiate(
      from, paths, {{Parameter::transmitter_position(0), Parameter::transmitter_position(2)}});
  ASSERT_TRUE(derivatives) << derivatives.error().message;
  for (const double one :
       derivatives->loss_gradient(paths, carrier, std::vector<std::complex<double>>{{1.0, 0.5}})) {
    EXPECT_TRUE(std::isfinite(one));
  }
  const RadioMaterial air{"air", 1.0, 0.0, 0.1};
  EXPECT_TRUE(DiffuseTracer(room(rough(air, kLambertian)), {})
                  .density(from, receiver_in_room())
                  .echoes()
                  .empty());
}

// --- A plain integration, which shares nothing with the tracer but the antennas. --------------

using V = Vec3d;

V unit(const V& v) { return (1.0 / norm(v)) * v; }

// Rodrigues: about an axis, by an angle.
V rotated(const V& v, const V& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) +
         ((1.0 - std::cos(angle)) * dot(axis, v)) * axis;
}

struct PlainLink {
  LinkEnd<double> from;
  LinkEnd<double> to;
  SurfaceScattering scattering;

  // [1/m^2] of a perfect reflector with the normal n, by Lambert's law.
  double density(const V& point, const V& n) const {
    const V in = unit(point - from.position);
    const V out = unit(to.position - point);
    const double cos_in = -dot(in, n);
    const double cos_out = dot(out, n);
    if (cos_in <= 0.0 || cos_out <= 0.0) {
      return 0.0;
    }
    const auto field = [](const LinkEnd<double>& end, const V& direction) {
      return antenna_field(end.pattern, end.polarization, end.world_from_antenna, direction);
    };
    const V sent = field(from, in);
    const V mirrored_ray = in + (2.0 * cos_in) * n;
    const V mirrored_field = sent - (2.0 * dot(sent, n)) * n;
    const V axis = unit(cross(mirrored_ray, out));
    const V kept = rotated(mirrored_field, axis, std::acos(dot(mirrored_ray, out)));
    const V received = field(to, -out);
    const double co = dot(kept, received);
    const double other = dot(cross(out, kept), received);
    const double r2 = dot(point - from.position, point - from.position) *
                      dot(point - to.position, point - to.position);
    const double s2 = scattering.scattering_coefficient * scattering.scattering_coefficient;
    const double xpd = scattering.xpd_coefficient;
    return std::pow(kWavelength / (4.0 * kPi), 2) / r2 * s2 * cos_in * cos_out / kPi *
           ((1.0 - xpd) * co * co + xpd * other * other);
  }
};

// True if the segment meets the upright sheet x = 2, 0.5 <= y <= 1.5, z <= 1.4.
bool meets_sheet(const V& a, const V& b) {
  const double share = (2.0 - a.x) / (b.x - a.x);
  const V at = a + share * (b - a);
  return share > 0.0 && share < 1.0 && at.y > 0.5 && at.y < 1.5 && at.z < 1.4;
}

TEST(Diffuse, DensityIsThatOfFinePatches) {
  const SurfaceScattering scattering{0.6, 0.3, ScatteringPattern::kLambertian};
  Scene::Input input{{}, {rough(kMetal, scattering), kMetal}, test::kCarrier};
  input.objects.push_back({"floor", test::rectangle_mesh({0, 0, 0}, {5, 0, 0}, {0, 4, 0}), 0});
  input.objects.push_back({"wall", test::rectangle_mesh({0, 4, 0}, {5, 0, 0}, {0, 0, 3}), 0});
  input.objects.push_back({"sheet", test::rectangle_mesh({2, 0.5, 0}, {0, 1, 0}, {0, 0, 1.4}), 1});
  auto scene = Scene::create(std::move(input));
  ASSERT_TRUE(scene.has_value());
  const DiffuseTracer tracer(std::make_shared<const Scene>(std::move(*scene)), {});
  // The second link is close to the floor, the third has the sheet between.
  for (const auto& ends : {std::pair<V, V>{{0.7, 2.9, 1.3}, {3.2, 2.1, 1.6}},
                           std::pair<V, V>{{1.1, 2.2, 0.08}, {3.0, 3.9, 0.9}},
                           std::pair<V, V>{{1.2, 0.9, 0.8}, {3.1, 1.1, 0.9}}}) {
    const V& from = ends.first;
    const V& to = ends.second;
    Transmitter transmitter = transmitter_in_room();
    transmitter.position = from;
    Receiver receiver = receiver_in_room();
    receiver.position = to;
    const PlainLink link{link_end(transmitter), link_end(receiver), scattering};
    constexpr int kSteps = 500;
    double plain = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < kSteps; ++j) {
        const double x = 5.0 * (i + 0.5) / kSteps;
        const double y = (j + 0.5) / kSteps;
        const auto add = [&](const V& point, const V& normal, double area) {
          if (!meets_sheet(from, point) && !meets_sheet(to, point)) {
            plain += area / (kSteps * kSteps) * link.density(point, normal);
          }
        };
        add({x, 4.0 * y, 0.0}, {0, 0, 1}, 20.0);
        add({x, 4.0, 3.0 * y}, {0, -1, 0}, 15.0);
      }
    }
    const DiffuseDensity density = tracer.density(transmitter, receiver);
    EXPECT_NEAR(decibels(density.power() / plain), 0.0, 0.1) << density.echoes().size();
    EXPECT_LE(density.error(), 0.01 * density.power());
  }
}

// One patch, received all around: it scatters S^2 of the power that a smooth one would reflect.
TEST(Diffuse, PatchScattersTheUnreflectedPower) {
  for (const SurfaceScattering& scattering : {kLambertian, kBackscattering}) {
    const auto scene =
        test::make_scene({{"floor", test::rectangle_mesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})}},
                         rough(test::kConcrete, scattering));
    const TraceContext context(scene, diffuse_options({}));
    const RoughMaterials materials(context);
    const RoughMaterial<double>& material = *materials.of_surface(0);
    const auto leg = [&](const V& position, Polarization polarization) {
      LinkEnd<double> end;
      end.position = position;
      end.polarization = polarization;
      end.world_from_antenna = rotation({});
      return leg_to_patch<double>(
          end, {}, [&](std::uint32_t) { return context.facets[0]; }, {0, 0, 0}, kWavelength);
    };
    for (const double zenith : {0.1, 0.7, 1.3}) {
      double scattered = 0.0;
      double reflected = 0.0;
      for (const auto polarization : {Polarization::kVertical, Polarization::kHorizontal}) {
        const auto in = leg({2.0 * std::sin(zenith), 0.0, 2.0 * std::cos(zenith)}, polarization);
        const double cos_in = std::cos(zenith);
        // With a gain of 1, at 2 m; without 1 / 4 pi.
        reflected += cos_in / 4.0 * smooth_reflectance(cos_in, context.facets[0], kWavelength);
        constexpr int kSteps = 120;
        for (int i = 0; i < kSteps; ++i) {
          for (int j = 0; j < kSteps; ++j) {
            const double theta = 0.5 * kPi * (i + 0.5) / kSteps;
            const double phi = 2.0 * kPi * (j + 0.5) / kSteps;
            const V to{3.0 * std::sin(theta) * std::cos(phi),
                       3.0 * std::sin(theta) * std::sin(phi),
                       3.0 * std::cos(theta)};
            const double solid_angle = std::sin(theta) * (0.5 * kPi / kSteps) * (2 * kPi / kSteps);
            for (const auto received : {Polarization::kVertical, Polarization::kHorizontal}) {
              const auto scattered_ray = scattered_path<double>(
                  material, context.facets[0], in, leg(to, received), kWavelength);
              scattered += solid_angle * scattered_ray.power(material) * 9.0 *
                           std::pow(4.0 * kPi / kWavelength, 2);
            }
          }
        }
      }
      const double s = scattering.scattering_coefficient;
      EXPECT_NEAR(scattered / (s * s * reflected), 1.0, 2e-3) << zenith;
      EXPECT_NEAR(scattered + (1.0 - s * s) * reflected, reflected, 1e-3 * reflected);
    }
  }
}

TEST(Diffuse, EndsMayBeExchanged) {
  const auto scene = room(rough(test::kConcrete, kBackscattering));
  const Transmitter transmitter = transmitter_in_room();
  const Receiver receiver = receiver_in_room();
  const Transmitter back{receiver};
  const Receiver there{transmitter};
  for (const bool transmission : {false, true}) {
    const TraceOptions trace{.max_depth = 4, .transmission = transmission};
    const DiffuseTracer tracer(scene, trace, {.reflections = 1, .tolerance = 0.05});
    const DiffuseDensity density = tracer.density(transmitter, receiver);
    EXPECT_NEAR(tracer.density(back, there).power() / density.power(), 1.0, 1e-9);
    // The other polarisation changes its sign: without it the field is the same too.
    SurfaceScattering kept = kBackscattering;
    kept.xpd_coefficient = 0.0;
    const DiffuseField field(
        room(rough(test::kConcrete, kept)), trace, {.reflections = 1, .spacing = 0.5, .seed = 3});
    const OfdmGrid grid{test::kCarrier, 0.0, {0}};
    const auto h = field.between(field.lit_by(transmitter), field.lit_by(receiver)).cfr(grid);
    const auto h_back = field.between(field.lit_by(back), field.lit_by(there)).cfr(grid);
    EXPECT_NEAR(std::abs(h[0] - h_back[0]), 0.0, 1e-9 * std::abs(h[0]));
  }
}

// --- Derivatives. -----------------------------------------------------------------------------

double step_of(Kind kind) {
  switch (kind) {
    case Kind::kThickness:
    case Kind::kTransmitterPosition:
    case Kind::kReceiverPosition:
      return 2e-5;
    case Kind::kConductivity:
      return 1e-4;
    default:
      return 1e-3;
  }
}

std::vector<Parameter> parameters_of_scattering() {
  std::vector<Parameter> parameters{Parameter::transmitter_gain(),
                                    Parameter::receiver_gain(),
                                    Parameter::relative_permittivity(0),
                                    Parameter::conductivity(0),
                                    Parameter::thickness(0)};
  for (const Kind kind : {Kind::kScatteringCoefficient,
                          Kind::kXpdCoefficient,
                          Kind::kAlphaReflected,
                          Kind::kAlphaBack,
                          Kind::kLobeShare}) {
    parameters.push_back(Parameter::scattering(kind, 0));
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const Kind kind : {Kind::kTransmitterPosition,
                            Kind::kReceiverPosition,
                            Kind::kTransmitterOrientation,
                            Kind::kReceiverOrientation,
                            Kind::kTransmitterArrayTurn,
                            Kind::kReceiverArrayTurn}) {
      parameters.push_back({kind, 0, axis});
    }
  }
  return parameters;
}

TEST(Diffuse, DerivativesMatchCentralDifferences) {
  const TraceOptions trace{.max_depth = 3, .transmission = true};
  const DiffuseOptions options{.reflections = 1, .tolerance = 1.0};
  ChangedLink link{room(rough(test::kConcrete, kBackscattering)),
                   transmitter_in_room(),
                   receiver_in_room(),
                   1.0};
  link.receiver.lever = {0.03, -0.05, 0.02};
  link.transmitter.lever = {0.01, 0.04, 0.0};
  const DiffuseTracer tracer(link.scene, trace, options);
  // Some of the points are enough.
  std::vector<DiffuseEcho> echoes;
  constexpr std::size_t kEvery = 41;
  const DiffuseDensity all = tracer.density(link.transmitter, link.receiver);
  echoes.reserve(all.echoes().size() / kEvery + 1);
  for (std::size_t i = 0; i < all.echoes().size(); i += kEvery) {
    echoes.push_back(all.echoes()[i]);
  }
  ASSERT_GT(echoes.size(), 50U);
  const DiffuseDensity density(std::move(echoes), 0.0);
  const std::vector<Parameter> parameters = parameters_of_scattering();
  const auto derivatives =
      tracer.differentiate(density, link.transmitter, link.receiver, parameters);
  ASSERT_TRUE(derivatives.has_value()) << derivatives.error().message;
  const bool print = std::getenv("RAYLOC_PRINT_GRADIENTS") != nullptr;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double step = step_of(parameters[i].kind);
    std::array<double, 4> power{};
    std::array<double, 4> delay{};
    constexpr std::array<double, 4> kSteps{-2, -1, 1, 2};
    for (std::size_t k = 0; k < kSteps.size(); ++k) {
      const double by = kSteps.at(k) * step;
      const auto changed = change_link(link, {&parameters[i], 1}, {&by, 1});
      ASSERT_TRUE(changed.has_value());
      const DiffuseDensity moved = DiffuseTracer(changed->scene, trace, options)
                                       .again(density, changed->transmitter, changed->receiver);
      power.at(k) = changed->gain * changed->gain * moved.power();
      delay.at(k) = moved.echoes().front().tau;
    }
    const auto difference = [&](const std::array<double, 4>& f) {
      return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step);
    };
    const double numeric = difference(power);
    const double error = std::abs(derivatives->power(i) - numeric) / std::abs(numeric);
    EXPECT_LE(error, 1e-6) << i << ": " << derivatives->power(i) << " against " << numeric;
    EXPECT_NEAR(derivatives->at(0, i).tau, difference(delay), 1e-16);
    if (print) {
      std::printf(
          "| %d.%d | %.1e |\n", static_cast<int>(parameters[i].kind), parameters[i].axis, error);
    }
  }
}

// Nothing in the way: the derivative is that of the whole density, integrated anew.
TEST(Diffuse, DerivativeByPlaceIsThatOfTheWholeIntegral) {
  const auto scene = test::make_scene({{"room", test::box_mesh({0, 0, 0}, {4, 3, 2.5})}},
                                      rough(test::kConcrete, kBackscattering));
  const DiffuseTracer tracer(scene, {}, {.tolerance = 1e-7});
  const Transmitter transmitter = transmitter_in_room();
  const Receiver receiver = receiver_in_room();
  const Parameter parameter = Parameter::receiver_position(0);
  const auto derivatives = tracer.differentiate(
      tracer.density(transmitter, receiver), transmitter, receiver, {&parameter, 1});
  ASSERT_TRUE(derivatives.has_value());
  const auto power_at = [&](double x) {
    Receiver moved = receiver;
    moved.position.x += x;
    return tracer.density(transmitter, moved).power();
  };
  constexpr double kStep = 0.01;
  const double numeric =
      (power_at(-2 * kStep) - 8 * power_at(-kStep) + 8 * power_at(kStep) - power_at(2 * kStep)) /
      (12 * kStep);
  EXPECT_NEAR(derivatives->power(0) / numeric, 1.0, 1e-4);
}

TEST(Diffuse, RefusesUnsupportedDerivatives) {
  const Transmitter transmitter = transmitter_in_room();
  const Receiver receiver = receiver_in_room();
  const auto message_of = [&](const RadioMaterial& material, const Parameter& parameter) {
    const DiffuseTracer tracer(room(material), {});
    const auto found = tracer.differentiate(
        tracer.density(transmitter, receiver), transmitter, receiver, {&parameter, 1});
    return found ? std::string() : found.error().message;
  };
  const RadioMaterial lambertian = rough(test::kConcrete, kLambertian);
  EXPECT_NE(message_of(lambertian, Parameter::surface_offset(0)).find("trace anew"),
            std::string::npos);
  EXPECT_NE(
      message_of(lambertian, Parameter::scattering(Kind::kAlphaReflected, 0)).find("no such lobe"),
      std::string::npos);
  EXPECT_NE(
      message_of(test::kConcrete, Parameter::scattering(Kind::kXpdCoefficient, 0)).find("above 0"),
      std::string::npos);
}

// --- Realisations. ----------------------------------------------------------------------------

TEST(DiffuseField, MeanPowerIsThatOfTheDensity) {
  const auto scene = room(rough(test::kConcrete, kBackscattering));
  const Transmitter transmitter = transmitter_in_room();
  const Receiver receiver = receiver_in_room();
  const double density = DiffuseTracer(scene, {}).density(transmitter, receiver).power();
  const OfdmGrid grid{test::kCarrier, 0.0, {0}};
  double mean = 0.0;
  double of_paths = 0.0;
  constexpr std::uint64_t kSeeds = 200;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const DiffuseField field(scene, {}, {.spacing = 0.4, .seed = seed});
    const Paths paths = field.between(field.lit_by(transmitter), field.lit_by(receiver));
    mean += std::norm(paths.cfr(grid)[0]) / kSeeds;
    for (const Path& path : paths) {
      of_paths += abs2(path.a) / kSeeds;
    }
  }
  EXPECT_NEAR(decibels(of_paths / density), 0.0, 0.2);
  // The mean of so many exponential variables is known to 7 %, three times that is allowed.
  EXPECT_NEAR(mean / density, 1.0, 0.21);
}

TEST(DiffuseField, FieldChangesSmoothlyAndFades) {
  const auto scene = test::make_scene({{"room", test::box_mesh({0, 0, 0}, {4, 3, 2.5})}},
                                      rough(test::kConcrete, kBackscattering));
  const DiffuseField field(scene, {}, {.seed = 7});
  const auto transmitter = field.lit_by(transmitter_in_room());
  const OfdmGrid grid{test::kCarrier, 0.0, {0}};
  const auto at = [&](double x) {
    Receiver receiver = receiver_in_room();
    receiver.position.x += x;
    return field.between(transmitter, field.lit_by(receiver)).cfr(grid)[0];
  };
  const double level = std::sqrt(
      DiffuseTracer(scene, {}).density(transmitter_in_room(), receiver_in_room()).power());
  std::complex<double> before = at(0.0);
  double farthest = 0.0;
  for (int millimetre = 1; millimetre <= 60; ++millimetre) {
    const std::complex<double> here = at(1e-3 * millimetre);
    // A wave turns by at most 2 pi / 58 a millimetre.
    EXPECT_LT(std::abs(here - before), 0.3 * level) << millimetre;
    farthest = std::max(farthest, std::abs(here - at(0.0)));
    before = here;
  }
  EXPECT_GT(farthest, level);
  EXPECT_NE(DiffuseField(scene, {}, {.seed = 8}).between(transmitter, transmitter).cfr(grid)[0],
            field.between(transmitter, transmitter).cfr(grid)[0]);
}

}  // namespace
}  // namespace rayloc::diffuse_test
