// `rayloc simulate` of a room that people live in: heights, tilts, powers, a second day.
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/site/model/room_model.h"
#include "engine/base/constants.h"
#include "engine/scene/antenna_array.h"
#include "tests/support/closet_plan.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/verb_folder.h"

namespace rayloc::simulate_lived_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Json = nlohmann::json;
using Value = std::complex<double>;

constexpr const char* kFurniture = R"([[box]]
name = "crate"
material = "metal"
centre = [0.9, -0.7, 0.3]
size = [0.4, 0.4, 0.6]
[[box]]
name = "cupboard"
material = "wood"
centre = [-1.2, -0.9, 0.9]
size = [0.5, 0.5, 1.8]
)";

constexpr const char* kPoints =
    "t_start,t_end,x,y,z\n100,101,0.4,-0.2,1.2\n102,103,-0.3,0.3,1.2\n104,105,0.1,0.6,1.2\n";
constexpr const char* kWalk =
    "t,x,y,z\n100.05,0.4,-0.2,1.2\n100.1,0.37,-0.18,1.2\n100.15,0.34,-0.16,1.2\n";

class SimulateLived : public test::VerbFolder {
 protected:
  SimulateLived() : VerbFolder("simulate_lived_" + test_name()) {}

  void SetUp() override {
    write("plan.toml",
          std::string(test::kCloset) + kFurniture +
              test::closet_access_point("ap1", "[-1.3, 1.0, 2.2]", -38));
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
    write("points.csv", kPoints);
    write("walk.csv", kWalk);
  }
  Finished simulate(const std::string& points, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        "simulate", path("site"), "--points", path(points), "--out", path("a.pcap"), "--seed", "5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RaylocProcess(arguments).wait();
  }
  Json report(const std::string& points, std::vector<std::string> more) const {
    more.emplace_back("--force");
    const Finished finished = simulate(points, more);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return Json::parse(finished.out);
  }
  // [frame][element][tone] of the recording, elements in order of the array.
  std::vector<std::vector<std::vector<Value>>> channels() const {
    std::vector<std::vector<std::vector<Value>>> frames;
    std::istringstream lines(run({"frames", path("a.pcap"), "--json", "--values"}));
    for (std::string line; std::getline(lines, line);) {
      const Json json = Json::parse(line);
      if (!json.contains("csi")) {
        continue;
      }
      auto& frame = frames.emplace_back();
      for (const std::size_t row : {1U, 0U, 2U}) {  // cores 2, 0, 3 of 0, 2, 3
        auto& tones = frame.emplace_back();
        for (const Json& pair : json["csi"][row][0]) {
          tones.emplace_back(pair[0].get<double>(), pair[1].get<double>());
        }
      }
    }
    return frames;
  }
};

// By line of sight alone, phases are those of the lengths from the stated place, to the antennas.
TEST_F(SimulateLived, TheTruthIsWhereTheRecordingWasMade) {
  const Json truth = report("points.csv",
                            {"--impairments",
                             "none",
                             "--depth",
                             "0",
                             "--frames",
                             "1",
                             "--height-sigma",
                             "0.3",
                             "--truth",
                             path("truth.csv")});
  const auto site = load_site(path("site"));
  ASSERT_TRUE(site) << site.error().message;
  const AntennaArray& array = site->access_points[0].array;
  const auto frames = channels();
  ASSERT_EQ(frames.size(), 3U);
  // Largest difference of a phase from that of the height, but for one phase of the whole frame.
  const auto worst = [&](std::size_t i, double z) {
    const Json& point = truth["points"][i];
    const Vec3d place{point["x"], point["y"], z};
    std::vector<Value> rotated;
    Value sum;
    for (std::size_t element = 0; element < 3; ++element) {
      const double length = norm(place - element_position(array, element));
      for (std::size_t k = 0; k < frames[i][element].size(); ++k) {
        const double turns = site->carrier.grid.frequency_hz(k) * length / kSpeedOfLight;
        const Value& received = frames[i][element][k];
        rotated.push_back(received / std::abs(received) *
                          std::polar(1.0, 2.0 * std::numbers::pi * turns));
        sum += rotated.back();
      }
    }
    double largest = 0.0;
    for (const Value& value : rotated) {
      largest = std::max(largest, std::abs(std::arg(value * std::conj(sum))));
    }
    return largest;
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double z = truth["points"][i]["z"];
    EXPECT_GT(std::abs(z - 1.2), 0.02);
    EXPECT_LT(worst(i, z), 0.005);
    EXPECT_GT(worst(i, 1.2), 4.0 * worst(i, z));
    EXPECT_EQ(truth["points"][i]["x"], i == 0 ? 0.4 : i == 1 ? -0.3 : 0.1);
  }
  std::istringstream csv(read("truth.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "t_start,t_end,x,y,z,tilt_deg,tilt_towards_deg,power_db");
  std::getline(csv, line);
  std::ostringstream z;
  z.precision(6);
  z << std::fixed << truth["points"][0]["z"].get<double>();
  EXPECT_THAT(line, HasSubstr("100.000000000,101.000000000,0.400000,-0.200000," + z.str()));
}

TEST_F(SimulateLived, AWalkSendsAFrameAtEachRowAndItsTruthIsAWalk) {
  const Json truth = report("walk.csv",
                            {"--height-sigma",
                             "0.3",
                             "--tilt-deg",
                             "35",
                             "--power-sigma-db",
                             "4",
                             "--truth",
                             path("truth.csv")});
  EXPECT_EQ(truth["frames"], 3);
  EXPECT_EQ(truth["handling"]["tilt_deg"], 35.0);
  const auto z = [&](std::size_t i) { return truth["points"][i]["z"].get<double>(); };
  EXPECT_LT(std::abs(z(1) - z(0)), 0.03);
  EXPECT_NE(z(1), z(0));
  EXPECT_GT(truth["points"][0]["tilt_deg"].get<double>(), 0.0);
  EXPECT_NE(truth["points"][0]["power_db"].get<double>(), 0.0);
  EXPECT_THAT(read("truth.csv"), HasSubstr("t,x,y,z,tilt_deg"));
  EXPECT_THAT(read("truth.csv"), HasSubstr("\n100.050000000,0.400000,-0.200000,"));
}

TEST_F(SimulateLived, APowerCycleOnTheSecondDayChangesOnlyChainPhases) {
  const auto day = write("day.toml", "base = \"none\"\nchain_phase_deg = 180\n");
  const std::vector<std::string> common = {"--impairments", "none", "--frames", "1"};
  const Json first = report("points.csv", common);
  const auto before = channels();
  auto later = common;
  later.insert(later.end(), {"--second-day", day});
  const Json second = report("points.csv", later);
  const auto after = channels();
  EXPECT_FALSE(first.contains("second_day"));
  EXPECT_EQ(second["second_day"]["things"].size(), 0U);
  EXPECT_EQ(first["points"], second["points"]);
  EXPECT_NE(first["access_points"][0]["chains"], second["access_points"][0]["chains"]);
  ASSERT_EQ(before.size(), after.size());
  std::vector<Value> turn(3);
  for (std::size_t i = 0; i < before.size(); ++i) {
    for (std::size_t element = 0; element < 3; ++element) {
      Value product;
      double own = 0.0;
      double theirs = 0.0;
      for (std::size_t k = 0; k < before[i][element].size(); ++k) {
        product += after[i][element][k] * std::conj(before[i][element][k]);
        own += std::norm(before[i][element][k]);
        theirs += std::norm(after[i][element][k]);
      }
      EXPECT_NEAR(std::norm(product) / (own * theirs), 1.0, 1e-5) << "one factor for all tones";
      turn[element] = i == 0 ? product : turn[element];
      EXPECT_NEAR(std::arg(product * std::conj(turn[element])), 0.0, 1e-3) << "and all places";
    }
  }
  EXPECT_GT(std::abs(std::arg(turn[1] * std::conj(turn[0]))), 0.02);
}

TEST_F(SimulateLived, TheUsualSecondDayIsReportedAndTheSameBytesForASeed) {
  const Json once = report("points.csv", {"--second-day", "default"});
  const std::string bytes = read("a.pcap");
  EXPECT_EQ(report("points.csv", {"--second-day", "default"}), once);
  EXPECT_EQ(read("a.pcap"), bytes);
  const Json& day = once["second_day"];
  EXPECT_EQ(day["moved_things"], 3);
  ASSERT_EQ(day["things"].size(), 1U);
  EXPECT_EQ(day["things"][0]["objects"], Json::array({"crate"}));
  const auto moved = day["access_points"][0]["moved_m"].get<std::vector<double>>();
  EXPECT_NEAR(std::hypot(moved[0], moved[1], moved[2]), 0.002, 1e-9);
  EXPECT_NE(report("points.csv", {}), once);
  EXPECT_NE(read("a.pcap"), bytes);
  EXPECT_THAT(simulate("points.csv", {"--second-day", "default", "--force"}).err,
              HasSubstr("1 of 3 things were moved"));
}

TEST_F(SimulateLived, RefusesInvalidOptions) {
  struct Case {
    std::string points;
    std::vector<std::string> options;
    int status;
    std::string message;
  };
  const auto day = write("day.toml", "base = \"none\"\nchair = 2\n");
  const auto exists = write("truth.csv", "mine");
  for (const Case& one : {
           Case{"points.csv", {"--height-sigma", "-0.1"}, 64, "--height-sigma"},
           Case{"points.csv", {"--tilt-deg", "200"}, 64, "--tilt-deg"},
           Case{"points.csv", {"--power-sigma-db", "99"}, 64, "--power-sigma-db"},
           Case{"points.csv", {"--person", "--height-sigma", "0.3"}, 64, "--person"},
           Case{"points.csv", {"--person", "--tilt-deg", "3"}, 64, "--person"},
           Case{"points.csv", {"--second-day", day}, 78, "day.toml:2:1: unknown key 'chair'"},
           Case{"points.csv", {"--second-day", path("none.toml")}, 78, "none.toml"},
           Case{"points.csv", {"--truth", exists}, 69, "truth.csv: exists already"},
           Case{"walk.csv", {"--survey-error", "0.01"}, 64, "instants of a walk"},
       }) {
    const Finished finished = simulate(one.points, one.options);
    EXPECT_EQ(finished.status, one.status) << one.message << finished.err;
    EXPECT_THAT(finished.err, HasSubstr(one.message));
    EXPECT_FALSE(fs::exists(path("a.pcap"))) << one.message;
  }
  EXPECT_EQ(read("truth.csv"), "mine");
}

}  // namespace
}  // namespace rayloc::simulate_lived_test
