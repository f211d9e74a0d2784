#include "daemon/live/service/process_health.h"

#include <chrono>
#include <string>

#include <gmock/gmock.h>

namespace rayloc::process_health_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

double value_of(const ProcessHealth& health, const std::string& name) {
  for (const ExtraMetric& metric : health.metrics()) {
    if (metric.name == name) {
      return metric.samples.at(0).value;
    }
  }
  ADD_FAILURE() << name;
  return -1.0;
}

TEST(ProcessHealth, ASiteHasItsOwnStuckStagesAndThoseOfTheProcess) {
  ProcessHealth health;
  health.note_stuck({"publisher", "site 'hall': estimation", "site 'attic': estimation"});
  ServiceHealth hall;
  health.fill(hall, "site 'hall': ");
  EXPECT_THAT(hall.stuck_stages, ElementsAre("publisher", "site 'hall': estimation"));
  ServiceHealth only;
  health.fill(only, "");
  EXPECT_THAT(only.stuck_stages,
              ElementsAre("publisher", "site 'hall': estimation", "site 'attic': estimation"));
  EXPECT_EQ(value_of(health, "rayloc_stages_stuck"), 3.0);
  health.note_stuck({});
  EXPECT_THAT(health.stuck_stages(), IsEmpty());
}

TEST(ProcessHealth, AFailedReloadKeepsTheConfiguration) {
  ProcessHealth health;
  const ConfigValues values;
  health.note_reload(true, &values, Timestamp(std::chrono::seconds(5)));
  const std::string json = health.config_json();
  EXPECT_EQ(json, values.json());
  EXPECT_FALSE(health.reload_failed());
  health.note_reload(false, nullptr, Timestamp(std::chrono::seconds(9)));
  EXPECT_EQ(health.config_json(), json);
  EXPECT_TRUE(health.reload_failed());
  ServiceHealth site;
  health.fill(site, "");
  EXPECT_TRUE(site.reload_failed);
  EXPECT_EQ(value_of(health, "rayloc_config_last_reload_successful"), 0.0);
  EXPECT_EQ(value_of(health, "rayloc_config_last_reload_timestamp_seconds"), 9.0);
}

}  // namespace
}  // namespace rayloc::process_health_test
