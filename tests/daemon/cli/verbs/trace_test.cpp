// `rayloc trace` as a process of its own, against the reference channels (tests/data/goldens).
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <fstream>
#include <map>
#include <numbers>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "tests/support/golden.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::trace_test {
namespace {

using nlohmann::json;

const std::string kRoom = test::data_path("/sites/meeting_room/scene.xml");
const std::string kSite = test::data_path("/sites/meeting_room");

std::string point(const json& v) {
  return fmt::format("{},{},{}", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

Finished trace(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "trace");
  return RaylocProcess(std::move(arguments)).wait();
}

json trace_json(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const Finished finished = trace(std::move(arguments));
  EXPECT_EQ(finished.status, 0) << finished.err;
  return finished.status == 0 ? json::parse(finished.out) : json();
}

std::complex<double> complex_of(const json& v) { return {v[0].get<double>(), v[1].get<double>()}; }

// The arguments of a link of a furnished room.
std::vector<std::string> link_of(const json& doc, const json& link) {
  const json& transmitter = doc.at("transmitter");
  return {kRoom,
          "--tx",
          point(transmitter.at("elements").at(link.at("tx_element").get<std::size_t>())),
          "--rx",
          point(doc.at("receivers").at(link.at("rx").get<std::size_t>())),
          "--frequency",
          "5.18e9",
          "--orientation-tx",
          point(transmitter.at("orientation"))};
}

// One path of each is the same: where it goes, and to the tolerances of the README there.
void expect_same_paths(const json& found, const json& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (const json& wanted : expected) {
    const auto match = std::find_if(found.begin(), found.end(), [&](const json& path) {
      return path["kinds"] == wanted["kinds"] && path["objects"] == wanted["objects"] &&
             std::abs(path["tau"].get<double>() / wanted["tau"].get<double>() - 1.0) < 1e-12;
    });
    ASSERT_NE(match, found.end()) << wanted;
    const json& path = *match;
    const double tau = wanted["tau"];
    const double free_space = 1.0 / (4.0 * std::numbers::pi * 5.18e9 * tau);
    EXPECT_LT(std::abs(complex_of(path["a"]) - complex_of(wanted["a"])), 1e-10 * free_space);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(path["angles"][i].get<double>(), wanted["angles"][i].get<double>(), 1e-10);
    }
    for (std::size_t i = 0; i < wanted["vertices"].size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(path["vertices"][i][axis].get<double>(),
                    wanted["vertices"][i][axis].get<double>(),
                    1e-9);
      }
    }
  }
}

void expect_same_cfr(const json& found, const json& expected) {
  ASSERT_EQ(found.size(), expected.size());
  double largest = 0.0;
  for (const json& h : expected) {
    largest = std::max(largest, std::abs(complex_of(h)));
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT(std::abs(complex_of(found[i]) - complex_of(expected[i])), 1e-8 * largest);
  }
}

TEST(TraceVerb, ReflectionsAreThoseOfTheReference) {
  const json doc = test::golden("meeting_room");
  const json& link = doc.at("links").at(4);
  std::vector<std::string> arguments = link_of(doc, link);
  arguments.insert(arguments.end(), {"--cfr", "5.18e9,312500,128"});
  const json found = trace_json(arguments);
  EXPECT_EQ(found["frequency"], 5.18e9);
  EXPECT_FALSE(found.contains("note"));
  expect_same_paths(found["paths"], link.at("paths"));
  expect_same_cfr(found["cfr"], link.at("cfr"));
}

TEST(TraceVerb, TransmissionIsThatOfTheReference) {
  const json doc = test::golden("meeting_room_transmission");
  // None of the links with coincident paths (the README of the goldens).
  const auto link =
      std::find_if(doc.at("links").begin(), doc.at("links").end(), [](const json& each) {
        return each.at("rx") != 0 && each.at("rx") != 3;
      });
  ASSERT_NE(link, doc.at("links").end());
  std::vector<std::string> arguments = link_of(doc, *link);
  arguments.insert(arguments.end(), {"--transmission", "--depth", "3"});
  expect_same_paths(trace_json(arguments)["paths"], link->at("paths"));
}

TEST(TraceVerb, GradientIsThatOfTheReference) {
  const json doc = test::golden("meeting_room");
  const json reference = test::golden("meeting_room_gradients").at("cases").at(1);
  std::string what = "power:";
  for (const auto& [name, value] : reference.at("d").items()) {
    what += (what.back() == ':' ? "" : ",") + name;
  }
  double power = 0.0;
  std::map<std::string, double> gradient;
  for (std::size_t element = 0; element < 3; ++element) {
    const json link = {{"tx_element", element}, {"rx", reference.at("receiver")}};
    std::vector<std::string> arguments = link_of(doc, link);
    arguments.insert(arguments.end(), {"--cfr", "5.18e9,312500,128", "--gradient", what});
    const json found = trace_json(arguments);
    power += found["power"].get<double>();
    for (const auto& [name, value] : found["gradient"].items()) {
      gradient[name] += value.get<double>();
    }
  }
  EXPECT_NEAR(power, reference.at("P").get<double>(), 1e-12 * power);
  ASSERT_EQ(gradient.size(), reference.at("d").size());
  for (const auto& [name, derivative] : reference.at("d").items()) {
    const double expected = derivative.at("dP");
    // A chair that no path touches: its finite difference is rounding.
    const double tolerance = std::max(1e-6 * std::abs(expected), 1e-12 * power);
    EXPECT_NEAR(gradient.at(name), expected, tolerance) << name;
  }
}

TEST(TraceVerb, PatternsPolarizationsAndOrientationsAreOfEachEnd) {
  const double k = 299'792'458.0 / (4.0 * std::numbers::pi * 5.18e9);  // at one metre
  const auto amplitude = [](const std::vector<std::string>& more) {
    // Two metres along x, in the middle of the corridor of the meeting room.
    std::vector<std::string> arguments{
        kRoom, "--frequency", "5.18e9", "--depth", "0", "--tx", "-1,0,1.3", "--rx", "1,0,1.3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return complex_of(trace_json(arguments)["paths"][0]["a"]).real();
  };
  EXPECT_NEAR(amplitude({}), k / 2.0, 1e-12);
  EXPECT_NEAR(amplitude({"--polarization", "H"}), -k / 2.0, 1e-12);
  EXPECT_NEAR(amplitude({"--polarization", "V,H"}), 0.0, 1e-12);
  // Directivity 1.5 of a short dipole, 1.643 of a half-wave one (Balanis), broadside.
  EXPECT_NEAR(amplitude({"--pattern", "dipole"}), 1.5 * k / 2.0, 1e-12);
  EXPECT_NEAR(
      amplitude({"--pattern", "isotropic,half_wave_dipole"}), std::sqrt(1.643) * k / 2.0, 1e-12);
  // Rolled by 60 degrees about the line between them: cos(60 degrees).
  EXPECT_NEAR(amplitude({"--orientation-rx", "0,0,1.0471975511965976"}), k / 4.0, 1e-12);
}

TEST(TraceVerb, NumbersHaveSeventeenDigits) {
  const Finished finished =
      trace({kSite, "--tx", "0.4,1.0,1.5", "--rx", "-1.4,1.05,1.2", "--depth", "1", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  const std::regex tau(R"("tau":[0-9]\.[0-9]{15,16}e-0[0-9])");
  std::size_t count = 0;
  for (std::sregex_iterator i(finished.out.begin(), finished.out.end(), tau), end; i != end; ++i) {
    ++count;
  }
  EXPECT_GE(count, 5U) << finished.out;
  EXPECT_EQ(json::parse(finished.out)["frequency"], 5.19e9);  // of the site
}

TEST(TraceVerb, TableShowsTheStrongestFirst) {
  const Finished finished =
      trace({kSite, "--tx", "0.4,1.0,1.5", "--rx", "-1.4,1.05,1.2", "--depth", "1"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.out.find("7 paths at 5.19 GHz\nkinds  power [dB]"), 0U) << finished.out;
  const std::size_t line_of_sight = finished.out.find("\n-          -51.98       6.089      1.826");
  const std::size_t window = finished.out.find("\nR          -53.40");
  ASSERT_NE(line_of_sight, std::string::npos) << finished.out;
  ASSERT_NE(window, std::string::npos) << finished.out;
  EXPECT_LT(line_of_sight, window);
}

TEST(TraceVerb, SoftVisibilityIsPassedOn) {
  const std::vector<std::string> link{
      kRoom, "--tx", "0.4,1.0,1.5", "--rx", "-1.4,1.05,1.2", "--depth", "1", "--soft", "0.2"};
  const json found = trace_json(link);
  EXPECT_TRUE(std::any_of(found["paths"].begin(), found["paths"].end(), [](const json& path) {
    return path["kinds"].get<std::string>().find('S') != std::string::npos;
  })) << found;
}

TEST(TraceVerb, DiffuseScatteringIsOfMaterialsThatStateIt) {
  const std::vector<std::string> link{"--tx", "1,1,1", "--rx", "3,2,1.5", "--diffuse"};
  const auto of = [&](const std::string& scene) {
    std::vector<std::string> arguments{scene};
    arguments.insert(arguments.end(), link.begin(), link.end());
    return arguments;
  };
  const Finished smooth = trace(of(kSite));
  EXPECT_EQ(smooth.status, 65);
  EXPECT_NE(smooth.err.find("no material of the scene scatters"), std::string::npos);
  const std::string file = ::testing::TempDir() + fmt::format("/rough_{}.xml", getpid());
  std::ofstream(file) << R"(<scene version="3.0.0"><bsdf type="itu-radio-material" id="mat-wall">
      <string name="type" value="concrete"/><float name="scattering_coefficient" value="0.4"/></bsdf>
      <shape type="cube" id="room"><transform name="to_world"><scale x="2" y="1.5" z="1.25"/>
      <translate x="2" y="1.5" z="1.25"/></transform><ref id="mat-wall" name="bsdf"/></shape></scene>)";
  const json found = trace_json(of(file));
  const json& diffuse = found.at("diffuse");
  double sum = 0.0;
  for (const json& bin : diffuse.at("profile")) {
    sum += bin.get<double>();
  }
  EXPECT_GT(diffuse.at("power").get<double>(), 0.0);
  EXPECT_NEAR(sum / diffuse.at("power").get<double>(), 1.0, 1e-9);
  EXPECT_GE(diffuse.at("mean_delay").get<double>(), found.at("paths")[0].at("tau").get<double>());
  EXPECT_NE(trace(of(file)).out.find("scattered: "), std::string::npos);
  std::remove(file.c_str());
}

TEST(TraceVerb, NoPathIsAResultWithANote) {
  const Finished inside = trace({kSite,
                                 "--tx",
                                 "0,0,0.73",
                                 "--rx",
                                 "-1.4,1.05,1.2",
                                 "--cfr",
                                 "5.19e9,312500,2",
                                 "--gradient",
                                 "power:rx.0",
                                 "--json"});
  EXPECT_EQ(inside.status, 0);
  EXPECT_EQ(inside.out,
            "{\"frequency\":5190000000,\"paths\":[],\"cfr\":[[0,0],[0,0]],\"power\":0,"
            "\"gradient\":{\"rx.0\":0},"
            "\"note\":\"the transmitter is inside of object 'table'; no path\"}\n");
  EXPECT_EQ(inside.err, "rayloc trace: the transmitter is inside of object 'table'; no path\n");

  const Finished outside = trace({kSite, "--tx", "9,0,1", "--rx", "-1.4,1.05,1.2"});
  EXPECT_EQ(outside.status, 0);
  EXPECT_EQ(outside.out, "0 paths at 5.19 GHz\n");
  EXPECT_EQ(outside.err, "rayloc trace: no path\n");
}

TEST(TraceVerb, WrongCallsExitWith64) {
  const std::vector<std::string> link{kSite, "--tx", "0,0,1", "--rx", "1,0,1"};
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--depth", "-1"},
                                             {"--depth", "x"},
                                             {"--soft", "-1"},
                                             {"--soft", "nan"},
                                             {"--frequency", "0"},
                                             {"--pattern", "yagi"},
                                             {"--polarization", "X"},
                                             {"--orientation-tx", "1,2"},
                                             {"--cfr", "5e9,312500"},
                                             {"--cfr", "5e9,312500,0"},
                                             {"--cfr", "5e9,312500,1.5"},
                                             {"--cfr", "5e9,0,8"},
                                             {"--gradient", "power:nothing"},
                                             {"--unknown"}}) {
    std::vector<std::string> arguments = link;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished finished = trace(arguments);
    EXPECT_EQ(finished.status, 64) << more[0] << " " << more.back();
    EXPECT_EQ(finished.out, "") << more[0] << " " << more.back();
    EXPECT_NE(finished.err, "") << more[0] << " " << more.back();
  }
  EXPECT_EQ(trace({kSite, "--tx", "0,0,1"}).status, 64);
  const Finished same = trace({kSite, "--tx", "0,0,1", "--rx", "0,0,1"});
  EXPECT_EQ(same.status, 64);
  EXPECT_EQ(same.err, "rayloc: --tx and --rx are the same point; give two different points\n");
}

TEST(TraceVerb, UnusableScenesAreRefusedWithTheirPlace) {
  const Finished frequency =
      trace({kRoom, "--tx", "0,0,1", "--rx", "1,0,1", "--frequency", "200e9"});
  EXPECT_EQ(frequency.status, 65);
  EXPECT_NE(frequency.err.find(kRoom + ":8:5: material 'concrete': ITU-R P.2040-4 states"),
            std::string::npos)
      << frequency.err;
  EXPECT_EQ(trace({"/nowhere/scene.xml", "--tx", "0,0,1", "--rx", "1,0,1"}).status, 65);
  EXPECT_EQ(trace({"/nowhere/site.toml", "--tx", "0,0,1", "--rx", "1,0,1"}).status, 78);
}

}  // namespace
}  // namespace rayloc::trace_test
