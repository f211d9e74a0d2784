#include "daemon/lab/experiment/experiment_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/lab/simulate/second_day.h"
#include "daemon/site/scene/room_plan.h"
#include "tests/support/test_paths.h"

namespace rayloc::experiment_file_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kHead = "name = \"n\"\n[defaults]\nroom = \"rooms/a.toml\"\nspots = 7\n";

Experiment read(const std::string& studies) {
  auto experiment = parse_experiment(kHead + studies, "folder/e.toml");
  EXPECT_TRUE(experiment) << experiment.error().message;
  return experiment ? *experiment : Experiment();
}

std::string refusal(const std::string& text) {
  const auto experiment = parse_experiment(text, "folder/e.toml");
  EXPECT_FALSE(experiment) << text;
  return experiment ? "" : experiment.error().message;
}

TEST(ExperimentFile, ValuesAreHeldAndListsAreAxes) {
  const Experiment experiment = read(
      "[[study]]\nname = \"s\"\nclaim = \"c\"\nboxes = [2, 4]\npaper.alpha = [0, 1, 5]\n"
      "paper.smoothing = false\nspots = 3\n");
  ASSERT_EQ(experiment.studies.size(), 1U);
  const Study& study = experiment.studies.front();
  EXPECT_EQ(study.claim, "c");
  EXPECT_THAT(study.axes, ElementsAre("boxes", "paper.alpha"));
  EXPECT_EQ(study.over, "boxes");
  ASSERT_EQ(study.conditions.size(), 6U);
  const Condition& fifth = study.conditions[4];
  EXPECT_EQ(fifth.boxes, 4.0);
  EXPECT_EQ(fifth.paper_options().descent.alpha, 1.0);
  EXPECT_FALSE(fifth.paper_options().descent.is_smoothed);
  EXPECT_EQ(fifth.test_points, 3.0);
  EXPECT_EQ(fifth.room, "folder/rooms/a.toml");
  EXPECT_EQ(experiment.seed, 1U);
}

TEST(ExperimentFile, WithoutListsThereIsOneCondition) {
  const Study study = read("[[study]]\nname = \"s\"\n").studies.front();
  EXPECT_EQ(study.conditions.size(), 1U);
  EXPECT_TRUE(study.axes.empty());
  EXPECT_EQ(study.over, "");
  EXPECT_EQ(study.conditions.front().test_points, 7.0);
}

TEST(ExperimentFile, ChartsRunOverTheAxisThatIsNamed) {
  const std::string lists =
      "boxes = [1, 2]\ndistance_m = [2, 3]\nmethod = [\"rayloc\", \"paper\"]\n";
  EXPECT_EQ(read("[[study]]\nname = \"s\"\nover = \"distance_m\"\n" + lists).studies[0].over,
            "distance_m");
  EXPECT_THAT(refusal(std::string(kHead) + "[[study]]\nname = \"s\"\nover = \"method\"\n" + lists),
              HasSubstr("e.toml:7:8: 'method' is no list of numbers"));
}

TEST(ExperimentFile, ErrorsNameTheirPlace) {
  const std::string head(kHead);
  const std::string study = head + "[[study]]\nname = \"s\"\n";
  EXPECT_THAT(refusal(study + "bxes = 2\n"), HasSubstr("folder/e.toml:7:"));
  EXPECT_THAT(refusal(study + "bxes = 2\n"), HasSubstr("'boxes'"));
  EXPECT_THAT(refusal(study + "paper.alhpa = 2\n"), HasSubstr("'alpha'"));
  EXPECT_THAT(refusal(study + "boxes = [2, 2.5]\n"), HasSubstr("whole numbers"));
  EXPECT_THAT(refusal(study + "sight = \"maybe\"\n"), HasSubstr("any, los, nlos"));
  EXPECT_THAT(refusal(study + "boxes = [2, 1000]\n"), HasSubstr("e.toml:7:13: 'boxes' is 1000"));
  EXPECT_THAT(refusal(study + "paper.window = 4\n"), HasSubstr("e.toml:7:"));
  EXPECT_THAT(refusal(study + "[[study]]\nname = \"s\"\n"), HasSubstr("a second study 's'"));
  EXPECT_THAT(refusal("name = \"n\"\n[[study]]\nname = \"s\"\n"), HasSubstr("states no 'room'"));
  EXPECT_THAT(refusal(head), HasSubstr("no [[study]]"));
  EXPECT_THAT(refusal(head + "boxes = [1, 2]\n[[study]]\nname = \"s\"\n"),
              HasSubstr("e.toml:5:9: 'boxes' is a list"));
}

// Settings that the file does not state are the paper's for the kind that is located.
TEST(ExperimentFile, PeopleHaveThePapersDefaultsForPeople) {
  const Study study = read(
                          "[[study]]\nname = \"s\"\nkind = [\"device\", \"person\"]\n"
                          "method = \"paper\"\npaper.alpha = 5\n")
                          .studies.front();
  ASSERT_EQ(study.conditions.size(), 2U);
  const Condition& device = study.conditions[0];
  const Condition& person = study.conditions[1];
  EXPECT_EQ(condition_text(device, "paper.sigma_0_squared"), "1");
  EXPECT_EQ(condition_text(person, "paper.sigma_0_squared"), "0.1");
  EXPECT_EQ(condition_text(device, "paper.alpha"), "5");
  EXPECT_EQ(condition_text(person, "paper.alpha"), "5");
  EXPECT_EQ(person.paper_options().centre_weight, 2.0);
}

TEST(ExperimentFile, RefusesTooManyConditions) {
  std::string list = "[0";
  for (int i = 1; i < 101; ++i) {
    list += ", " + std::to_string(i);
  }
  EXPECT_THAT(refusal(std::string(kHead) + "[[study]]\nname = \"s\"\nboxes = " + list +
                      "]\npaper.alpha = " + list + "]\n"),
              HasSubstr("more than 10000 conditions"));
}

// Running them takes minutes, reading them must always work.
TEST(ExperimentFile, TheShippedExperimentsAndTheirRoomsCanBeRead) {
  const std::filesystem::path folder = test::source_path("/deploy/experiments");
  for (const char* name :
       {"paper.toml", "ablation.toml", "ablation_people.toml", "lived_in.toml"}) {
    const auto experiment = load_experiment(folder / name);
    ASSERT_TRUE(experiment) << experiment.error().message;
    for (const Study& study : experiment->studies) {
      for (const Condition& condition : study.conditions) {
        const auto plan = load_room_plan(condition.room);
        ASSERT_TRUE(plan) << plan.error().message;
        EXPECT_GE(static_cast<double>(plan->access_points.size()), condition.access_points);
        if (condition.second_day != "none" && condition.second_day != "default") {
          const auto day = load_second_day(condition.room.parent_path() / condition.second_day);
          EXPECT_TRUE(day) << day.error().message;
        }
      }
    }
  }
}

}  // namespace
}  // namespace rayloc::experiment_file_test
