// Tests the text of `rayloc status`.
#include "daemon/cli/feed/status_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::cli::status_text_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

SiteStatus site_status(const std::string& name) {
  return {name,
          nlohmann::json::parse(R"({"ready": false, "reasons": ["source ap2: nothing has come yet"],
            "warnings": ["people are not looked for"], "clock": "unknown"})"),
          nlohmann::json::parse(R"({
            "software_version": "1.2.3", "started": "2026-11-26T22:00:00.123456789Z",
            "sources": [
              {"access_point": "ap1", "status": "SOURCE_STATUS_RECEIVING", "age": "0.023330128s",
               "counters": {"received": "300", "frames_complete": "70", "frames_partial": "5",
                            "rejected": {"not_udp": "2", "wrong_port": "1"}, "kernel_drops": "3",
                            "ring_dropped": "1", "late": "0", "frames_dropped": "7"}},
              {"access_point": "ap2", "status": "SOURCE_STATUS_SILENT",
               "counters": {"received": "0", "rejected": {}}}],
            "estimation": {"fixes": "40", "no_fixes": "2", "bursts_merged": "1",
                           "bursts_dropped": "0"},
            "compared": [{"method": "music", "fixes": "39", "no_fixes": "3",
                          "bursts_dropped": "0"}],
            "tracker": {"tracks": 4}, "person_tracker": {"tracks": 1},
            "publisher": {"published": "900", "subscriptions": 2, "slow_episodes": "0"}})")};
}

TEST(StatusText, HasReadinessSourcesAndEstimates) {
  EXPECT_EQ(status_text({site_status("")}).text,
            "raylocd 1.2.3 since 2026-11-26T22:00:00Z: not ready\n"
            "  source ap2: nothing has come yet\n"
            "  warning: people are not looked for\n"
            "  clock: synchronisation unknown to raylocd; timedatectl shows it\n"
            "ap1          receiving           300 datagrams       75 frames (5 partial)      3 "
            "rejected     11 lost  0.0 s ago\n"
            "ap2          silent                0 datagrams        0 frames (0 partial)      0 "
            "rejected      0 lost  no datagram yet\n"
            "40 fixes, 2 without a position, 4 tracks of devices, 1 of people; 1 bursts gave way "
            "to newer ones, 0 were left out; 900 messages to 2 subscriptions, 0 times one was "
            "slow\n"
            "compared music: 39 fixes, 3 without a position; 0 bursts dropped\n");
}

TEST(StatusText, SitesShareThePublisher) {
  SiteStatus failed = site_status("lab");
  failed.status = {{"error", "its scene cannot be read"}};
  const std::string text = status_text({failed, site_status("office")}).text;
  EXPECT_THAT(text, HasSubstr("site lab\nnot ready: its scene cannot be read\n\nsite office\n"));
  EXPECT_THAT(text, HasSubstr("0 were left out\n"));
  EXPECT_THAT(text, HasSubstr("\n\n900 messages to 2 subscriptions, 0 times one was slow\n"));
  EXPECT_THAT(status_text({failed}).text, Not(HasSubstr("messages")));
}

TEST(StatusText, LeavesOutAndNamesASiteWithAMalformedState) {
  SiteStatus lacking = site_status("lab");
  lacking.status.erase("estimation");
  SiteStatus miscounted = site_status("hall");
  miscounted.status["estimation"]["fixes"] = "many";
  SiteStatus untyped = site_status("attic");
  untyped.status = nlohmann::json::array();
  const StatusText all = status_text({lacking, miscounted, site_status("office"), untyped});
  EXPECT_EQ(all.text, status_text({site_status("office")}).text);
  ASSERT_EQ(all.malformed.size(), 3U);
  EXPECT_THAT(all.malformed[0], HasSubstr("the status of site 'lab' is malformed: "));
  EXPECT_THAT(all.malformed[0], HasSubstr("'estimation'"));
  EXPECT_THAT(all.malformed[1], HasSubstr("'hall' is malformed: a count is not a number"));
  EXPECT_THAT(all.malformed[2], HasSubstr("'attic' is malformed: "));
}

TEST(StatusText, ReportsAMalformedStateOfTheOnlySite) {
  SiteStatus lacking = site_status("");
  lacking.status.erase("publisher");
  const StatusText all = status_text({lacking});
  EXPECT_EQ(all.text, "");
  ASSERT_EQ(all.malformed.size(), 1U);
  EXPECT_THAT(all.malformed[0], HasSubstr("the status is malformed: "));
}

TEST(StatusText, JsonNamesASiteOfSeveral) {
  const auto one = nlohmann::json::parse(status_json(site_status("")));
  EXPECT_EQ(one.at("status").at("software_version"), "1.2.3");
  EXPECT_EQ(one.at("readiness").at("ready"), false);
  EXPECT_FALSE(one.contains("site"));
  EXPECT_EQ(nlohmann::json::parse(status_json(site_status("lab"))).at("site"), "lab");
}

}  // namespace
}  // namespace rayloc::cli::status_text_test
