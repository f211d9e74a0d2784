#include "daemon/live/log/limited_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/health/loss_watch.h"

namespace rayloc::limited_log_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

const LimitedLog::Time kStart{1000s};

struct Written {
  std::vector<std::string> lines;
  LimitedLog::Write write() {
    return [this](const LogEvent& event) {
      std::string line = event.message;
      for (const LogField& field : event.fields) {
        line += " " + field.name + "=" + field.value;
      }
      lines.push_back(line);
    };
  }
};

TEST(LimitedLog, WritesTheFirstAtOnceAndThenTheCountOncePerPeriod) {
  Written written;
  LimitedLog log(written.write(), 30s);
  for (int i = 0; i < 1000; ++i) {
    log.add("a", {LogLevel::kWarning, "a" + std::to_string(i)}, 2, kStart + i * 10ms);
  }
  EXPECT_THAT(written.lines, ElementsAre("a0"));
  log.flush(kStart + 29s);
  EXPECT_EQ(written.lines.size(), 1U);
  log.flush(kStart + 30s);
  EXPECT_THAT(written.lines, ElementsAre("a0", "a999 times=1998"));
  log.flush(kStart + 90s);
  EXPECT_EQ(written.lines.size(), 2U) << "nothing has happened since";
  log.add("a", {LogLevel::kWarning, "late"}, 1, kStart + 95s);
  EXPECT_EQ(written.lines.back(), "late times=1");
}

TEST(LimitedLog, AtTheEndNothingIsHeldBack) {
  Written written;
  LimitedLog log(written.write(), 30s);
  log.add("a", {LogLevel::kInfo, "a"}, 1, kStart);
  log.add("a", {LogLevel::kInfo, "again"}, 3, kStart + 1s);
  log.finish();
  EXPECT_THAT(written.lines, ElementsAre("a", "again times=3"));
  log.finish();
  EXPECT_EQ(written.lines.size(), 2U);
}

TEST(LimitedLog, SitesDoNotSilenceOneAnother) {
  Written written;
  LimitedLog log(written.write(), 30s);
  log.add("a", {LogLevel::kInfo, "a"}, 1, kStart);
  log.add("b", {LogLevel::kInfo, "b"}, 1, kStart + 1s);
  EXPECT_THAT(written.lines, ElementsAre("a", "b"));
}

TEST(LossWatch, NamesTheSourceTheKindAndTheTotal) {
  Written written;
  LossWatch watch(std::make_shared<LimitedLog>(written.write()));
  v1::Heartbeat heartbeat;
  v1::SourceReport& source = *heartbeat.add_sources();
  source.set_access_point("ap1");
  source.mutable_counters()->set_received(1000);
  watch.check(heartbeat);
  EXPECT_THAT(written.lines, ElementsAre()) << "nothing is lost";
  source.mutable_counters()->set_kernel_drops(7);
  (*source.mutable_counters()->mutable_rejected())["bad_magic"] = 3;
  watch.check(heartbeat);
  watch.check(heartbeat);
  EXPECT_THAT(written.lines,
              ElementsAre("source ap1: datagrams lost before we read them: see `rayloc doctor` "
                          "loss=kernel_drops source=ap1 total=7",
                          "source ap1: datagrams rejected: bad_magic loss=rejected_bad_magic "
                          "source=ap1 total=3"));
}

// One line for the first of each, then silence for half a minute.
TEST(LossWatch, ReportsTheLossesOfEveryStage) {
  Written written;
  LossWatch watch(std::make_shared<LimitedLog>(written.write()));
  v1::Heartbeat heartbeat;
  heartbeat.add_sources()->set_access_point("ap1");
  for (std::uint64_t count = 1; count < 4; ++count) {
    v1::SourceCounters& source = *heartbeat.mutable_sources(0)->mutable_counters();
    source.set_clock_steps(count);
    source.set_frames_dropped(count);
    heartbeat.mutable_publisher()->set_csi_dropped(count);
    heartbeat.mutable_snapshot_server()->set_dropped(count);
    heartbeat.mutable_ring_snapshots()->set_failed(count);
    heartbeat.mutable_recorder()->set_dropped(count);
    watch.check(heartbeat);
    watch.check_shared(heartbeat, count);
  }
  std::vector<std::string> kinds;
  for (const std::string& line : written.lines) {
    const std::size_t kind = line.find("loss=") + 5;
    kinds.push_back(line.substr(kind, line.find(' ', kind) - kind));
  }
  EXPECT_THAT(kinds,
              ::testing::UnorderedElementsAre("clock_steps",
                                              "frames_dropped",
                                              "csi_dropped",
                                              "snapshots_dropped",
                                              "snapshot_files_failed",
                                              "recorder_dropped",
                                              "log_dropped"));
}

// Sites share the publisher: the log of a site reports none of its losses.
TEST(LossWatch, OmitsSharedLossesForASite) {
  Written written;
  LossWatch watch(std::make_shared<LimitedLog>(written.write()), "site 'office': ");
  v1::Heartbeat heartbeat;
  heartbeat.mutable_publisher()->set_slow_episodes(1);
  heartbeat.mutable_publisher()->set_handshakes_failed(1);
  heartbeat.mutable_publisher()->set_clients_cut_off(1);
  heartbeat.mutable_snapshot_server()->set_dropped(1);
  heartbeat.mutable_snapshot_server()->set_malformed(1);
  watch.check(heartbeat);
  EXPECT_THAT(written.lines, ElementsAre());
  watch.check_shared(heartbeat, 0);
  EXPECT_EQ(written.lines.size(), 5U);
}

}  // namespace
}  // namespace rayloc::limited_log_test
