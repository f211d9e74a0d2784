// `rayloc experiment` as a process of its own.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/daemon/lab/experiment/small_room.h"
#include "tests/support/rayloc_process.h"

namespace rayloc::experiment_verb_test {
namespace {

constexpr const char* kExperiment = R"(name = "short"
[defaults]
room = "room.toml"
spots = 2
frames = 1
depth = 1
model_depth = 1
method = "paper"
paper.positions = 2
[[study]]
name = "steps"
paper.iterations = [0, 2]
)";

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(ExperimentVerb, WritesOneReportInThreeFormats) {
  const test::SmallRoomFolder folder("experiment-verb-test");
  const std::string file = folder.write("e.toml", kExperiment);
  const std::string out = folder.path() / "out";
  const Finished finished = RaylocProcess({"experiment", file, "--out", out}).wait();
  ASSERT_EQ(finished.status, 0) << finished.err;
  const auto json = nlohmann::json::parse(content(out + "/report.json"));
  EXPECT_EQ(json["studies"][0]["conditions"].size(), 2U);
  EXPECT_NE(content(out + "/report.csv").find("\nsteps,room,"), std::string::npos);
  EXPECT_EQ(content(out + "/errors.csv").find("study,condition,point,error_m\n1,1,1,"), 0U);
  EXPECT_NE(content(out + "/report.html").find("<svg"), std::string::npos);
  EXPECT_NE(RaylocProcess({"experiment", file, "--out", out}).wait().status, 0);  // not empty
}

TEST(ExperimentVerb, ReportsItsProgressToPrograms) {
  const test::SmallRoomFolder folder("experiment-verb-test");
  const std::string file = folder.write("e.toml", kExperiment);
  const std::string out = folder.path() / "out";
  const auto lines_of = [&](const char* option) {
    return RaylocProcess({"experiment", file, "--out", out, "--progress", "--quiet", option})
        .wait()
        .err;
  };
  const std::string lines = lines_of("--force");
  EXPECT_EQ(lines.find("progress 0.000 0 of 2 conditions\nprogress 0.500 steps: 1 of 2, median "),
            0U)
      << lines;
  EXPECT_NE(lines.find(" m\nprogress 1.000 steps: 2 of 2, median "), std::string::npos) << lines;
  EXPECT_EQ(lines_of("--resume"), lines);  // conditions that are kept are reported, too
}

TEST(ExperimentVerb, ExitsWith78AtAWrongFile) {
  const test::SmallRoomFolder folder("experiment-verb-test");
  const std::string file = folder.write("e.toml", std::string(kExperiment) + "bxes = 1\n");
  const Finished finished =
      RaylocProcess({"experiment", file, "--out", folder.path() / "out"}).wait();
  EXPECT_EQ(finished.status, 78);
  EXPECT_EQ(finished.err.find(file + ":13:"), 0U) << finished.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));
}

TEST(ExperimentVerb, HelpListsTheKeys) {
  const Finished finished = RaylocProcess({"experiment", "--help"}).wait();
  EXPECT_EQ(finished.status, 0);
  for (const char* part : {"Example:", "paper.sigma_0_squared = 1", "sight = \"any\""}) {
    EXPECT_NE(finished.out.find(part), std::string::npos) << part;
  }
}

}  // namespace
}  // namespace rayloc::experiment_verb_test
