// `rayloc evaluate` as a process of its own.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::evaluate_test {
namespace {

class EvaluatedFiles {
 public:
  EvaluatedFiles()
      : folder_(std::filesystem::temp_directory_path() /
                ("rayloc-evaluate-test." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~EvaluatedFiles() { std::filesystem::remove_all(folder_); }
  EvaluatedFiles(const EvaluatedFiles&) = delete;
  EvaluatedFiles& operator=(const EvaluatedFiles&) = delete;

  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  // 0.3 m off at the first test point, NO_FIX at the second, nothing at the third; the clock of the
  // estimates is 100 s ahead.
  std::string estimates() const {
    return file("e.jsonl",
                R"({"kind":"LOCATION_KIND_SNAPSHOT","time":"1970-01-01T00:01:50.5Z",)"
                R"("mode":"FIX_MODE_2D","target":{"kind":"TARGET_KIND_DEVICE","mac":"a"},)"
                R"("position":{"x":1.3,"y":2,"z":1},)"
                R"("position_covariance":[1,0,0,0,1,0,0,0,1]})"
                "\n"
                R"({"kind":"LOCATION_KIND_SNAPSHOT","time":"1970-01-01T00:02:00.5Z",)"
                R"("mode":"FIX_MODE_NO_FIX","target":{"kind":"TARGET_KIND_DEVICE","mac":"a"}})"
                "\n");
  }
  std::string truth() const {
    return file("t.csv", "t_start,t_end,x,y,z\n10,11,1,2,1\n20,21,1,2,1\n30,31,1,2,1\n");
  }

  const std::filesystem::path folder_;
};

class Evaluate : public ::testing::Test, protected EvaluatedFiles {};

TEST_F(Evaluate, PrintsTheKeysOfTheContract) {
  const Finished finished = RaylocProcess({"evaluate",
                                           "--estimates",
                                           estimates(),
                                           "--truth",
                                           truth(),
                                           "--time-offset",
                                           "100",
                                           "--json",
                                           "--site",
                                           test::data_path("/sites/meeting_room")})
                                .wait();
  ASSERT_EQ(finished.status, 0) << finished.err;
  const auto json = nlohmann::json::parse(finished.out);
  for (const char* key : {"n",
                          "missed",
                          "median_m",
                          "mean_m",
                          "rmse_m",
                          "cep50_m",
                          "cep90_m",
                          "cep95_m",
                          "below_0_5",
                          "below_1",
                          "coverage_50",
                          "coverage_95",
                          "anees",
                          "best_of_5_median_m",
                          "room_centre_median_m",
                          "fingerprint_median_m",
                          "ci95"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["n"], 3);
  EXPECT_EQ(json["missed"], 2);
  EXPECT_TRUE(json["median_m"].is_null());
  EXPECT_NEAR(json["located_mean_m"], 0.3, 1e-12);
  EXPECT_NEAR(json["below_0_5"], 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(json["anees"], 0.045, 1e-12);
  EXPECT_NEAR(json["room_centre_median_m"], 2.2360679774997896, 1e-12);
}

TEST_F(Evaluate, PrintsATable) {
  const Finished finished =
      RaylocProcess(
          {"evaluate", "--estimates", estimates(), "--truth", truth(), "--time-offset", "100"})
          .wait();
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("located                      1 of 3\n"), std::string::npos)
      << finished.out;
  EXPECT_NE(finished.out.find("median (CEP50)          missed      [0.300, missed]\n"),
            std::string::npos)
      << finished.out;
}

// With skills against controls, which are minus infinity where half is missed.
TEST(Field, EvaluateNeverPrintsInf) {
  const EvaluatedFiles files;
  const std::string nothing =
      files.file("n.jsonl",
                 R"({"kind":"LOCATION_KIND_SNAPSHOT","time":"1970-01-01T00:00:10.5Z",)"
                 R"("mode":"FIX_MODE_NO_FIX","target":{"kind":"TARGET_KIND_DEVICE","mac":"a"}})"
                 "\n");
  for (const auto& [name, offset] :
       {std::pair{nothing, "0"}, std::pair{files.estimates(), "100"}}) {
    std::vector<std::string> arguments = {
        "evaluate", "--estimates", name, "--truth", files.truth()};
    arguments.insert(arguments.end(), {"--time-offset", offset, "--site"});
    arguments.push_back(test::data_path("/sites/meeting_room"));
    const Finished finished = RaylocProcess(arguments).wait();
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_EQ((finished.out + finished.err).find("inf"), std::string::npos) << finished.out;
    EXPECT_EQ(finished.out.find("nan"), std::string::npos) << finished.out;
    EXPECT_NE(finished.out.find("CEP95                   missed"), std::string::npos)
        << finished.out;
    EXPECT_NE(finished.out.find("missed: so many points"), std::string::npos) << finished.out;
  }
}

TEST_F(Evaluate, DoesNotTakeSilenceAboutUncertaintyForNoCoverage) {
  const std::string silent =
      file("s.jsonl",
           R"({"kind":"LOCATION_KIND_SNAPSHOT","time":"1970-01-01T00:00:10.5Z",)"
           R"("mode":"FIX_MODE_2D","target":{"kind":"TARGET_KIND_DEVICE","mac":"a"},)"
           R"("position":{"x":1.3,"y":2,"z":1},"residual_probability":1})"
           "\n");
  const Finished table =
      RaylocProcess({"evaluate", "--estimates", silent, "--truth", truth()}).wait();
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_NE(table.out.find("in 95 % region       not stated\n"), std::string::npos) << table.out;
  const Finished finished =
      RaylocProcess({"evaluate", "--estimates", silent, "--truth", truth(), "--json"}).wait();
  const auto json = nlohmann::json::parse(finished.out);
  for (const char* key : {"coverage_50", "coverage_95", "anees", "best_of_5_median_m"}) {
    EXPECT_TRUE(json.at(key).is_null()) << key;
  }
  EXPECT_NEAR(json["located_mean_m"], 0.3, 1e-12);
}

// The survey's own recording as the target's: the most similar point is the right one.
TEST_F(Evaluate, ComparesWithTheMostSimilarSurveyedPoint) {
  const std::string site = test::data_path("/sites/meeting_room");
  std::vector<std::string> arguments = {"evaluate", "--site", site, "--json"};
  const auto add = [&](const std::string& option, const std::string& value) {
    arguments.push_back(option);
    arguments.push_back(value);
  };
  std::ifstream survey(site + "/calibration.csv");
  std::string header;
  std::string row;
  std::getline(survey, header);
  std::getline(survey, row);
  const std::string first = file("first.csv", header + "\n" + row + "\n");
  const std::string time = row.substr(0, row.find(','));
  add("--truth", first);
  add("--estimates",
      file("e.jsonl",
           R"({"kind":"LOCATION_KIND_SNAPSHOT","time":"1970-01-01T00:00:00Z",)"
           R"("mode":"FIX_MODE_2D","target":{"kind":"TARGET_KIND_DEVICE","mac":"a"},)"
           R"("position":{"x":0,"y":0,"z":1}})"
           "\n"));
  add("--time-offset", "-" + time);  // of the estimates' clock; recordings have the survey's
  add("--fingerprints", "ap1=" + site + "/calibration-ap1.pcap.gz");
  add("--points", site + "/calibration.csv");
  EXPECT_EQ(RaylocProcess(arguments).wait().status, 64);  // --capture is missing
  add("--capture", "ap1=" + site + "/calibration-ap1.pcap.gz");
  const Finished finished = RaylocProcess(arguments).wait();
  ASSERT_EQ(finished.status, 0) << finished.err;
  const auto json = nlohmann::json::parse(finished.out);
  EXPECT_EQ(json.at("fingerprint_median_m"), 0.0);
  EXPECT_TRUE(json.at("ci95").contains("fingerprint_median_m"));
}

TEST_F(Evaluate, DrawsPlots) {
  std::vector<std::string> arguments = {"evaluate",
                                        "--estimates",
                                        estimates(),
                                        "--truth",
                                        truth(),
                                        "--time-offset",
                                        "100",
                                        "--site",
                                        test::data_path("/sites/meeting_room"),
                                        "--plot",
                                        folder_ / "plots"};
  const Finished finished = RaylocProcess(arguments).wait();
  ASSERT_EQ(finished.status, 0) << finished.err;
  for (const char* name : {"cdf.svg", "map.svg", "coverage.svg", "reliability.svg"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "plots" / name)) << name;
  }
  const Finished again = RaylocProcess(arguments).wait();
  EXPECT_NE(again.status, 0);
  EXPECT_NE(again.err.find("plots"), std::string::npos) << again.err;
  arguments.emplace_back("--force");
  EXPECT_EQ(RaylocProcess(arguments).wait().status, 0);
}

TEST_F(Evaluate, ExitsWith65WhenNothingMatches) {
  const Finished no_offset =
      RaylocProcess({"evaluate", "--estimates", estimates(), "--truth", truth()}).wait();
  EXPECT_EQ(no_offset.status, 65);
  EXPECT_NE(no_offset.err.find("estimates from 110.500 to 120.500, truth from 10.000 to 31.000"),
            std::string::npos)
      << no_offset.err;
  const Finished other_kind =
      RaylocProcess(
          {"evaluate", "--estimates", estimates(), "--truth", truth(), "--kind", "person"})
          .wait();
  EXPECT_EQ(other_kind.status, 65);
  EXPECT_NE(other_kind.err.find("none of 2 estimates is a snapshot of a person"), std::string::npos)
      << other_kind.err;
}

TEST_F(Evaluate, ExitsWith65AtBadDataAnd64AtBadUsage) {
  const Finished bad =
      RaylocProcess({"evaluate", "--estimates", file("bad.jsonl", "{]"), "--truth", truth()})
          .wait();
  EXPECT_EQ(bad.status, 65);
  EXPECT_NE(bad.err.find("bad.jsonl:1:2: not JSON"), std::string::npos) << bad.err;
  EXPECT_EQ(RaylocProcess({"evaluate", "--estimates", estimates()}).wait().status, 64);
  EXPECT_EQ(
      RaylocProcess(
          {"evaluate", "--estimates", estimates(), "--truth", truth(), "--time-offset", "soon"})
          .wait()
          .status,
      64);
}

}  // namespace
}  // namespace rayloc::evaluate_test
