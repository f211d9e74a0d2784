// Derivatives of a loss of the channel by everything that has one, against central differences of
// the whole tracer, run anew in the scene so changed, and against reference values.
//
// Prints the table of engine/studies/2026-11-derivatives.md (its last row is that of
// target_gradients_test.cpp): RAYLOC_PRINT_GRADIENTS=1 engine_gradients_test
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "engine/scene/read/load_scene.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/golden.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"
#include "tests/support/traced_link.h"

namespace rayloc::gradients_test {
namespace {

using nlohmann::json;
using test::TracedLink;
using test::vec3;
using Kind = Parameter::Kind;

constexpr double kTolerance = 1e-6;  // relative
constexpr std::size_t kKinds = 13;   // of Parameter

// D = sum |h - reference|^2 with its gradient.
double distance2(const std::vector<std::complex<double>>& h,
                 const std::vector<std::complex<double>>& reference) {
  double sum = 0.0;
  for (std::size_t j = 0; j < h.size(); ++j) {
    sum += std::norm(h[j] - reference[j]);
  }
  return sum;
}

// Five-point difference; nothing when a path appears or vanishes within the step.
std::optional<double> difference(const TracedLink& link,
                                 const Parameter& parameter,
                                 const std::vector<std::complex<double>>& reference) {
  const double step = test::difference_step(parameter);
  const auto paths = link.path_keys();
  std::array<double, 4> value{};
  constexpr std::array<double, 4> kSteps{-2, -1, 1, 2};
  for (std::size_t i = 0; i < kSteps.size(); ++i) {
    const TracedLink moved = link.changed(parameter, kSteps.at(i) * step);
    if (moved.options().softness == 0.0 && moved.path_keys() != paths) {
      return std::nullopt;
    }
    value.at(i) = distance2(moved.csi(), reference);
  }
  return (value[0] - 8 * value[1] + 8 * value[2] - value[3]) / (12 * step);
}

struct Worst {
  double error = 0.0;  // relative
  std::string where;
  int compared = 0;
};

std::string name_of(Kind kind) {
  static const std::map<Kind, std::string> kNames{
      {Kind::kTransmitterPosition, "transmitter position"},
      {Kind::kReceiverPosition, "receiver position"},
      {Kind::kTransmitterOrientation, "transmitter orientation"},
      {Kind::kReceiverOrientation, "receiver orientation"},
      {Kind::kTransmitterArrayTurn, "array orientation"},
      {Kind::kReceiverArrayTurn, "receiver array orientation"},
      {Kind::kTransmitterGain, "transmitter gain"},
      {Kind::kReceiverGain, "receiver gain"},
      {Kind::kObjectTranslation, "object translation"},
      {Kind::kSurfaceOffset, "surface offset"},
      {Kind::kRelativePermittivity, "relative permittivity"},
      {Kind::kConductivity, "conductivity"},
      {Kind::kThickness, "thickness"}};
  return kNames.at(kind);
}

// Compares every parameter of the link; a minor one relative to the most important of its kind.
std::map<Kind, Worst> compare(const TracedLink& link) {
  const auto reference = link.reference();
  const std::vector<Parameter> parameters = link.parameters();
  const std::vector<double> gradient = link.gradient(parameters, [&](const auto& h) {
    std::vector<std::complex<double>> g(h.size());
    for (std::size_t j = 0; j < h.size(); ++j) {
      g[j] = 2.0 * (h[j] - reference[j]);
    }
    return g;
  });
  std::map<Kind, double> scale;
  std::map<std::size_t, double> numeric;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    EXPECT_TRUE(std::isfinite(gradient[i]));
    if (const auto value = difference(link, parameters[i], reference)) {
      numeric[i] = *value;
      scale[parameters[i].kind] = std::max(scale[parameters[i].kind], std::abs(*value));
    }
  }
  std::map<Kind, Worst> worst;
  for (const auto& [i, value] : numeric) {
    Worst& row = worst[parameters[i].kind];
    const double floor = 1e-3 * scale.at(parameters[i].kind);
    const double error = std::abs(gradient[i] - value) / std::max(std::abs(value), floor);
    if (!(error <= row.error)) {
      row.error = error;
      row.where = link.name_of(parameters[i]) + " " + std::to_string(gradient[i]) + " against " +
                  std::to_string(value);
    }
    ++row.compared;
  }
  return worst;
}

class Gradients : public ::testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(Gradients, MatchCentralDifferences) {
  const auto& [scene, softness] = GetParam();
  const bool print = std::getenv("RAYLOC_PRINT_GRADIENTS") != nullptr;
  const std::map<Kind, Worst> table =
      compare(TracedLink::of(scene, {.max_depth = 3, .softness = softness}));
  EXPECT_EQ(table.size(), kKinds);
  for (const auto& [kind, worst] : table) {
    EXPECT_GT(worst.compared, 0) << name_of(kind);
    EXPECT_LE(worst.error, kTolerance) << name_of(kind) << ": " << worst.where;
    if (print) {
      std::printf("| %s | %s, %s | %d | %.1e |\n",
                  name_of(kind).c_str(),
                  scene,
                  softness > 0.0 ? "soft" : "hard",
                  worst.compared,
                  worst.error);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheWholeTracer,
                         Gradients,
                         ::testing::Combine(::testing::Values("box", "meeting_room", "corridor"),
                                            ::testing::Values(0.0, 0.05)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) +
                                  (std::get<1>(test.param) > 0.0 ? "_soft" : "_hard");
                         });

TEST(GradientsWithTransmission, MatchCentralDifferences) {
  for (const double softness : {0.0, 0.05}) {
    const auto table = compare(
        TracedLink::of("box", {.max_depth = 4, .transmission = true, .softness = softness}));
    EXPECT_EQ(table.size(), kKinds);
    for (const auto& [kind, worst] : table) {
      EXPECT_LE(worst.error, kTolerance) << name_of(kind) << " " << softness << ": " << worst.where;
    }
  }
}

// The screen is moved a little: one antenna of the box is in its plane, where waves along it have a
// kink.
TEST(GradientsOverEdges, MatchCentralDifferences) {
  const bool print = std::getenv("RAYLOC_PRINT_GRADIENTS") != nullptr;
  for (const auto& [scene, depth, transmission, twice] :
       {std::tuple("box", 3, false, false),
        std::tuple("box", 3, true, false),
        std::tuple("box", 3, true, true),
        std::tuple("meeting_room", 2, false, false),
        std::tuple("corridor", 2, false, false)}) {
    TraceOptions options{.max_depth = depth, .transmission = transmission, .diffraction = true};
    options.double_diffraction = twice;
    const TracedLink straight = TracedLink::of(scene, options);
    const auto screen = static_cast<std::uint32_t>(straight.scene().objects().size() - 1);
    const auto table = compare(straight.changed(Parameter::object_translation(screen, 1), 0.013));
    EXPECT_EQ(table.size(), kKinds);
    for (const auto& [kind, worst] : table) {
      EXPECT_GT(worst.compared, 0) << name_of(kind);
      EXPECT_LE(worst.error, kTolerance) << scene << " " << name_of(kind) << ": " << worst.where;
      if (print) {
        std::printf("| %s | %s, %s%s | %d | %.1e |\n",
                    name_of(kind).c_str(),
                    scene,
                    twice ? "two edges" : "edges",
                    transmission ? ", transmission" : "",
                    worst.compared,
                    worst.error);
      }
    }
  }
}

// "rx.0", "table.2", "hi.1", "eps_r.wood", "eps_r": names of the reference files.
Parameter parameter_of(const std::string& name, const Scene& scene) {
  const std::size_t dot_at = name.find('.');
  const std::string what = name.substr(0, dot_at);
  const std::string which = dot_at == std::string::npos ? "" : name.substr(dot_at + 1);
  if (what == "eps_r" || what == "sigma" || what == "thickness") {
    std::uint32_t material = 0;
    while (!which.empty() && scene.materials()[material].name != which) {
      ++material;
    }
    return what == "eps_r"   ? Parameter::relative_permittivity(material)
           : what == "sigma" ? Parameter::conductivity(material)
                             : Parameter::thickness(material);
  }
  const int axis = std::stoi(which);
  if (what == "rx") {
    return Parameter::receiver_position(axis);
  }
  if (what == "tx") {
    return Parameter::transmitter_position(axis);
  }
  if (what == "rx_orientation") {
    return Parameter::receiver_array_turn(axis);
  }
  if (what == "tx_orientation") {
    return Parameter::transmitter_orientation(axis);
  }
  if (what == "lo" || what == "hi") {  // a wall of the box; its normals point outwards
    for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
      const Vec3d& n = scene.surfaces()[i].plane().normal;
      const double along = axis == 0 ? n.x : axis == 1 ? n.y : n.z;
      if (what == "hi" ? along > 0.5 : along < -0.5) {
        return Parameter::surface_offset(i);
      }
    }
  }
  std::uint32_t object = 0;
  while (scene.objects().at(object).name != what) {
    ++object;
  }
  return Parameter::object_translation(object, axis);
}

// dP of P = sum |h|^2 and dD of D = sum |h - h_ref|^2.
void expect_reference_gradients(const TracedLink& link, const test::Csi& reference, const json& d) {
  std::vector<Parameter> parameters;
  for (const auto& [name, value] : d.items()) {
    parameters.push_back(parameter_of(name, link.scene()));
  }
  const auto dp = link.gradient(parameters, [](test::Csi h) {
    std::for_each(h.begin(), h.end(), [](auto& value) { value *= 2.0; });
    return h;
  });
  const auto dd = link.gradient(parameters, [&](test::Csi h) {
    for (std::size_t j = 0; j < h.size(); ++j) {
      h[j] = 2.0 * (h[j] - reference[j]);
    }
    return h;
  });
  std::size_t i = 0;
  for (const auto& [name, stated] : d.items()) {
    // A lower wall moves along the axis, against its normal.
    const double sign = name.rfind("lo.", 0) == 0 ? -1.0 : 1.0;
    const json& value = stated;  // clang 14 captures no structured binding
    const json& spread = value.at("spread");
    const auto tolerance = [&](const char* key, std::size_t k) {
      return kTolerance * std::abs(value.at(key).get<double>()) + 10 * spread.at(k).get<double>() +
             1e-13;
    };
    EXPECT_NEAR(sign * dp[i], value.at("dP"), tolerance("dP", 0)) << name;
    EXPECT_NEAR(sign * dd[i], value.at("dD"), tolerance("dD", 1)) << name;
    ++i;
  }
}

TEST(GradientsOfTheReference, HoldInTheBox) {
  const json doc = test::golden("room_cases");
  for (const auto& [name, expected] : doc.at("gradients").items()) {
    SCOPED_TRACE(name);
    const json& c = doc.at("cases").at(name);
    const json& turn = c.at("rx_orientation");
    const json& tx_turn = c.at("tx_orientation");
    AntennaArray array;
    array.pose = {vec3(c.at("rx")), {turn.at(0), turn.at(1), turn.at(2)}};
    const double spacing = c.at("spacing");
    array.element_offset = {{0, -spacing, 0}, {0, 0, 0}, {0, spacing, 0}};
    const auto polarization = [&](std::size_t end) {
      return c.at("polarization").at(end) == "V" ? Polarization::kVertical
                                                 : Polarization::kHorizontal;
    };
    array.polarization = polarization(1);
    const Transmitter transmitter{{vec3(c.at("tx")),
                                   {tx_turn.at(0), tx_turn.at(1), tx_turn.at(2)},
                                   AntennaPattern::kIsotropic,
                                   polarization(0)}};
    const Scene::Input input{{{"room", test::box_mesh(vec3(c.at("lo")), vec3(c.at("hi"))), 0}},
                             {{"wall", c.at("eps_r"), c.at("sigma"), c.at("thickness")}},
                             doc.at("frequency")};
    const TraceOptions options{.max_depth = c.at("depth")};
    const TracedLink link(input, {transmitter}, array_elements<Receiver>(array), options);
    array.pose.position = vec3(expected.at("rx_of_reference"));
    const TracedLink moved(input, {transmitter}, array_elements<Receiver>(array), options);
    expect_reference_gradients(link, moved.csi(), expected.at("d"));
  }
}

TEST(GradientsOfTheReference, HoldInTheMeetingRoom) {
  const json doc = test::golden("meeting_room_gradients");
  const json transmitter = test::golden("meeting_room").at("transmitter");
  const json& turn = transmitter.at("orientation");
  std::vector<Transmitter> elements;
  for (const json& position : transmitter.at("elements")) {
    elements.push_back({{vec3(position), {turn.at(0), turn.at(1), turn.at(2)}}});
  }
  const auto scene =
      load_scene(test::data_path("/sites/meeting_room/scene.xml"), {doc.at("frequency"), {}});
  ASSERT_TRUE(scene) << scene.error().message;
  const Scene::Input input{scene->objects(), scene->materials(), scene->carrier_hz()};
  for (const json& c : doc.at("cases")) {
    SCOPED_TRACE("receiver " + c.at("receiver").dump());
    const TracedLink link(input, elements, {{{vec3(c.at("rx")), {}}}}, {.max_depth = 3});
    expect_reference_gradients(link, link.reference(), c.at("d"));
  }
}

// The derivative of the channel itself, tone by tone.
TEST(GradientsOfTheChannel, MatchCentralDifferences) {
  const TracedLink link = TracedLink::of("meeting_room", {.max_depth = 2});
  for (const Parameter& parameter : {Parameter::receiver_position(0), Parameter::thickness(0)}) {
    const test::Csi derivative = link.csi_derivative(parameter);
    const double step = test::difference_step(parameter);
    const test::Csi ahead = link.changed(parameter, step).csi();
    const test::Csi behind = link.changed(parameter, -step).csi();
    ASSERT_EQ(derivative.size(), ahead.size());
    double largest = 0.0;
    double worst = 0.0;
    for (std::size_t j = 0; j < derivative.size(); ++j) {
      largest = std::max(largest, std::abs(derivative[j]));
      worst = std::max(worst, std::abs((ahead[j] - behind[j]) / (2 * step) - derivative[j]));
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_LT(worst, 1e-5 * largest) << name_of(parameter.kind);  // second order only
  }
}

// Where textbook formulas divide by zero: no loss, normal and grazing incidence, an end above the
// other, both ends at one place, an end straight above an antenna.
TEST(GradientsAtTheEdge, AreFinite) {
  const RadioMaterial lossless{"glass", 6.31, 0.0, 0.01};
  const RadioMaterial air{"air", 1.0, 0.0, 0.1};
  const RadioMaterial metal{"metal", 1.0, 1e7, 0.1};
  const Vec3d base{0.3, -0.2, 1.0};
  const std::vector<Vec3d> others{base,
                                  {0.3, -0.2, 2.0},
                                  {0.3, 0.9, 1.0},
                                  {2.9, -0.2, 1e-4},
                                  {0.3 + 1e-8, -0.2, 1.0},
                                  {0.3, -0.2, 3.0 - 1e-6}};
  for (const RadioMaterial& material : {lossless, air, metal}) {
    const Scene::Input input{
        {{"room", test::box_mesh({-4, -4, 0}, {4, 4, 3}), 0}}, {material}, test::kCarrier};
    for (const auto pattern : {AntennaPattern::kIsotropic, AntennaPattern::kHalfWaveDipole}) {
      for (const Vec3d& other : others) {
        for (const double softness : {0.0, 0.05}) {
          const TracedLink link(input,
                                {{{base, {}, pattern}}},
                                {{{other, {}, pattern}}},
                                {.max_depth = 2, .softness = softness});
          const std::vector<Parameter> parameters = link.parameters();
          const auto gradient = link.gradient(parameters, [](const test::Csi& h) { return h; });
          for (std::size_t i = 0; i < gradient.size(); ++i) {
            EXPECT_TRUE(std::isfinite(gradient[i]))
                << material.name << " z " << other.z << " " << name_of(parameters[i].kind) << " "
                << link.name_of(parameters[i]);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace rayloc::gradients_test
