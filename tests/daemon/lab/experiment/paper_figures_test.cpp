// Tests deploy/experiments/paper_figures.toml in a form of two test points: every system has its
// row, and conditions outside its domain state the reason.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/daemon/lab/experiment/small_room.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::paper_figures_test {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// One room, two test points, twelve points, one epoch, hardly any descent.
std::string short_form() {
  std::string text = content(test::source_path("/deploy/experiments/paper_figures.toml"));
  const auto replace = [&](const char* pattern, const std::string& by) {
    text = std::regex_replace(text, std::regex(pattern, std::regex::multiline), by);
  };
  replace("^room = .*$",
          "room = \"" + test::source_path("/deploy/experiments/rooms/meeting_room.toml") + "\"");
  replace("^spots = .*$", "spots = 2");
  replace("^walk_s = .*$", "walk_s = 2.5");
  replace("^rate_hz = .*$", "rate_hz = 200");
  replace("^survey_points = .*$", "survey_points = 12\nepochs = 1");
  replace("^depth = .*$", "depth = 1\nmodel_depth = 1\npaper.iterations = 2\npaper.positions = 2");
  return text;
}

TEST(PaperFigures, HaveARowOfEverySystem) {
  const test::SmallRoomFolder folder("paper-figures-test");
  const std::string file = folder.write("figures.toml", short_form());
  const std::string out = folder.path() / "out";
  const std::vector<std::string> arguments = {"experiment",
                                              file,
                                              "--out",
                                              out,
                                              "--study",
                                              "Fig. 9: devices, four rooms, in sight",
                                              "--study",
                                              "Fig. 9: people, four rooms",
                                              "--study",
                                              "Widar2.0's own antennas and rates",
                                              "--study",
                                              "Fig. 13: access points, power unknown",
                                              "--study",
                                              "M3's own channels"};
  const Finished finished = RaylocProcess(arguments).wait();
  ASSERT_EQ(finished.status, 0) << finished.err;
  const std::string report = content(out + "/report.json");
  std::map<std::string, std::string> refused;  // the texts of each method
  std::set<std::string> methods;
  std::set<std::string> hops;
  const auto json = nlohmann::json::parse(report);
  for (const auto& study : json["studies"]) {
    EXPECT_FALSE(study["claim"].get<std::string>().empty());
    for (const auto& condition : study["conditions"]) {
      const std::string name = condition["values"]["method"];
      hops.insert(condition["values"]["channels"].get<std::string>());
      methods.insert(name);
      if (condition.contains("refused")) {
        refused[name] += condition["refused"].get<std::string>();
        EXPECT_EQ(condition["statistics"]["n"], condition["statistics"]["missed"]) << name;
      }
    }
  }
  EXPECT_EQ(methods,
            (std::set<std::string>{"centre",
                                   "cifi",
                                   "dscp",
                                   "level",
                                   "m3",
                                   "nearest",
                                   "oracle",
                                   "paper",
                                   "rayloc",
                                   "spotfi",
                                   "start",
                                   "widar2",
                                   "witraj"}));
  EXPECT_EQ(hops, (std::set<std::string>{"36", "36-48", "36-64", "36-64,100-144", "plan"}));
  EXPECT_EQ(refused.count("m3"), 0U);
  EXPECT_EQ(refused["widar2"], "widar2 tracks people who walk; here people are at rest");
  EXPECT_EQ(refused["witraj"], "witraj tracks people who walk; here people are at rest");
  EXPECT_NE(
      refused["spotfi"].find("one access point and no learned level: spotfi has a bearing and "
                             "no range"),
      std::string::npos)
      << refused["spotfi"];
  // Interrupted at the end and gone on: nothing is run again, and the report is the same.
  std::filesystem::remove(out + "/report.json");
  std::vector<std::string> again = arguments;
  again.emplace_back("--resume");
  ASSERT_EQ(RaylocProcess(again).wait().status, 0);
  EXPECT_EQ(content(out + "/report.json"), report);
  EXPECT_EQ(
      RaylocProcess({"experiment", file, "--out", out + "2", "--study", "Fig. 8"}).wait().status,
      64);
}

}  // namespace
}  // namespace rayloc::paper_figures_test
