#include "daemon/lab/experiment/run_experiment.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "daemon/lab/experiment/experiment_report.h"
#include "tests/daemon/lab/experiment/small_room.h"

namespace rayloc::run_experiment_test {
namespace {

constexpr const char* kStudies = R"(name = "short"
seed = 3
[defaults]
room = "room.toml"
spots = 3
frames = 2
depth = 1
model_depth = 1
impairments = "none"
[[study]]
name = "method"
method = ["rayloc", "paper"]
paper.iterations = 3
repeats = 2
access_points = 2
[[study]]
name = "steps"
method = "paper"
paper.iterations = [0, 4]
)";

class RunExperiment : public ::testing::Test {
 protected:
  RunExperiment() : folder_("run-experiment-test") {}

  std::vector<StudyResult> run(const Experiment& experiment) {
    auto results =
        run_experiment(experiment, [&](const Study&, std::size_t, const auto&) { ++reported_; });
    EXPECT_TRUE(results) << results.error().message;
    return results ? *std::move(results) : std::vector<StudyResult>();
  }
  Experiment experiment() {
    return *parse_experiment(kStudies, folder_.path() / "experiment.toml");
  }

  test::SmallRoomFolder folder_;
  int reported_ = 0;
};

// With a perfect model, two access points and no impairments our method is within a decimetre or
// so; three steps of the paper's from a random place are not.
TEST_F(RunExperiment, ComparesMethodsOnTheSameWorld) {
  const Experiment file = experiment();
  const auto results = run(file);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(reported_, 4);
  const ConditionResult& ours = results[0].conditions[0];
  const ConditionResult& papers = results[0].conditions[1];
  EXPECT_EQ(ours.points.size(), 6U);  // 3 test points, twice
  EXPECT_LT(ours.statistics.median_m, 0.15);
  EXPECT_TRUE(ours.statistics.coverage_95.has_value());
  EXPECT_GT(papers.statistics.median_m, ours.statistics.median_m);
  EXPECT_FALSE(papers.statistics.coverage_95.has_value());
  EXPECT_NE(papers.points[0].error, papers.points[1].error);  // another start
  EXPECT_EQ(ours.points[0].error, ours.points[1].error);      // draws nothing
  EXPECT_EQ(*ours.statistics.room_centre_median_m, *papers.statistics.room_centre_median_m);
}

TEST_F(RunExperiment, GivesTheSameBytesAgain) {
  const Experiment file = experiment();
  const auto first = run(file);
  const auto second = run(file);
  EXPECT_EQ(experiment_json(file, first), experiment_json(file, second));
  EXPECT_EQ(experiment_csv(first), experiment_csv(second));
  EXPECT_EQ(experiment_html(file, first), experiment_html(file, second));
}

TEST_F(RunExperiment, LocatesPeopleWithoutADevice) {
  const auto people = parse_experiment(R"(name = "people"
[defaults]
room = "room.toml"
kind = "person"
spots = 3
depth = 1
model_depth = 1
access_points = 2
[[study]]
name = "people"
[[study]]
name = "the paper's"
method = "paper"
repeats = 2
paper.iterations = 2
)",
                                       folder_.path() / "experiment.toml");
  ASSERT_TRUE(people) << people.error().message;
  const auto results = run(*people);
  ASSERT_EQ(results.size(), 2U);
  const ErrorStatistics& found = results[0].conditions[0].statistics;
  EXPECT_EQ(found.n, 3U);
  EXPECT_EQ(found.missed, 0U);
  EXPECT_LT(found.median_m, 0.3);
  // Two steps from a random place do not converge; each repeat begins at another place.
  const ConditionResult& papers = results[1].conditions[0];
  EXPECT_EQ(papers.points.size(), 6U);
  EXPECT_EQ(papers.statistics.missed, 0U);
  EXPECT_GT(papers.statistics.median_m, found.median_m);
  EXPECT_FALSE(papers.statistics.coverage_95.has_value());
  EXPECT_NE(papers.points[0].error, papers.points[1].error);
}

// A walk is evaluated every 0.1 s; a method that needs more frames states so.
TEST_F(RunExperiment, EvaluatesWalkingPeople) {
  const auto walking = parse_experiment(R"(name = "walking"
[defaults]
room = "room.toml"
kind = "person"
motion = "walk"
walk_s = 2.5
spots = 1
depth = 1
model_depth = 1
access_points = 2
[[study]]
name = "who walks"
rate_hz = 200
method = ["start", "centre", "rayloc", "witraj", "widar2"]
[[study]]
name = "too few frames"
rate_hz = 50
method = "witraj"
)",
                                        folder_.path() / "experiment.toml");
  ASSERT_TRUE(walking) << walking.error().message;
  const auto results = run(*walking);
  ASSERT_EQ(results.size(), 2U);
  const std::vector<ConditionResult>& of = results[0].conditions;
  ASSERT_EQ(of.size(), 5U);
  for (const ConditionResult& one : of) {
    EXPECT_EQ(one.points.size(), 25U) << one.condition.method;
    EXPECT_EQ(one.refusal, "") << one.condition.method;
  }
  // The start position is right at the start, and its error grows.
  const std::vector<PointResult>& start = of[0].points;
  EXPECT_LT(start[0].error, 1e-9);
  EXPECT_GT(start[10].error, start[1].error);
  EXPECT_EQ(of[0].statistics.missed, 0U);
  EXPECT_EQ(of[1].statistics.median_m, *of[1].statistics.room_centre_median_m);
  EXPECT_LT(of[2].statistics.median_m, 0.3);
  EXPECT_LT(of[3].statistics.missed, 25U);
  EXPECT_LT(of[4].statistics.missed, 25U);
  const ConditionResult& seldom = results[1].conditions[0];
  EXPECT_EQ(seldom.statistics.missed, 25U);
  EXPECT_NE(seldom.refusal.find("witraj needs"), std::string::npos) << seldom.refusal;
}

TEST_F(RunExperiment, RefusesADeviceThatWalks) {
  Experiment file = experiment();
  file.studies[0].conditions[0].motion = "walk";
  const auto results = run_experiment(file, [](const Study&, std::size_t, const auto&) {});
  ASSERT_FALSE(results);
  EXPECT_NE(results.error().message.find("motion"), std::string::npos);
}

// As behind a receiver: m3 has all frames of a device that hops, other methods have those of the
// plan's channel.
TEST_F(RunExperiment, DevicesHopForTheMethodThatUsesTheirChannels) {
  const auto file = [&](const std::string& frames) {
    return *parse_experiment(R"(name = "hops"
[defaults]
room = "room.toml"
spots = 3
depth = 1
model_depth = 1
impairments = "none"
access_points = 2
frames = )" + frames + R"(
[[study]]
name = "hops"
channels = ["plan", "36-48", "100"]
method = ["rayloc", "m3"]
)",
                             folder_.path() / "experiment.toml");
  };
  const Experiment hops = file("4");
  const auto results = run(hops);
  ASSERT_EQ(results.size(), 1U);
  const auto find = [&](const std::string& channels, const std::string& method) {
    return *std::find_if(results[0].conditions.begin(),
                         results[0].conditions.end(),
                         [&](const ConditionResult& result) {
                           return result.condition.channels == channels &&
                                  result.condition.method == method;
                         });
  };
  EXPECT_LT(find("36-48", "rayloc").statistics.median_m, 0.15);
  EXPECT_NE(find("100", "rayloc").refusal.find("channel"), std::string::npos);
  EXPECT_EQ(find("100", "m3").refusal, "");
  EXPECT_NE(find("36-48", "m3").points[0].error, find("plan", "m3").points[0].error);
  EXPECT_NE(experiment_csv(results).find("36-48"), std::string::npos);

  const Experiment few = file("1");
  const auto refused = run_experiment(few, [](const Study&, std::size_t, const auto&) {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kConfiguration);
  EXPECT_NE(refused.error().message.find("36-48"), std::string::npos) << refused.error().message;
}

TEST_F(RunExperiment, NamesThePlanThatIsMissing) {
  Experiment file = experiment();
  file.studies[0].conditions[0].room = "nowhere.toml";
  const auto results = run_experiment(file, [](const Study&, std::size_t, const auto&) {});
  ASSERT_FALSE(results);
  EXPECT_NE(results.error().message.find("nowhere.toml"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::run_experiment_test
