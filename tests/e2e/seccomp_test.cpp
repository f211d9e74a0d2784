// raylocd under the filters of deploy/units/raylocd.service: it starts, receives, records,
// publishes and stops. A library that needs a denied call fails here, not at the operator's.
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/unit_filters.h"

namespace rayloc::e2e::seccomp_test {
namespace {

using ::testing::HasSubstr;

const char* const kUnit = "raylocd.service";

// A daemon with a recorder under the unit's filters, and a second of datagrams.
void expect_works_with(const std::set<std::string>& calls, const std::string& families) {
  const TemporaryFolder folder;
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""),
       .access_points = {"ap2"},
       .more_configuration = "[record]\ndirectory = \"" + (folder.path() / "rec").string() + "\"\n",
       .setting = {.wrapper = filters(folder.path(), calls, families)}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_FALSE(daemon.bodies("location").empty()) << daemon.errors();
  EXPECT_EQ(number(daemon.bodies("heartbeat").back().at("recorder").at("written")), 2000U);
}

class Seccomp : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_filters()) {
      GTEST_SKIP() << "this build has no filters of system calls";
    }
  }
};

TEST_F(Seccomp, TheDaemonWorksUnderTheFiltersOfItsUnit) {
  const std::set<std::string> calls = allowed_calls(kUnit);
  ASSERT_GT(calls.size(), 200U);
  EXPECT_EQ(calls.count("mount") + calls.count("sched_setaffinity") + calls.count("ptrace"), 0U);
  EXPECT_THAT(unit_text(kUnit), HasSubstr("RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6\n"));
  expect_works_with(calls, "1,2,10");
}

// The kernel's answer is denied there, so it must not be taken for one.
TEST_F(Seccomp, TheStateOfTheClockIsUnknownWhereItCannotBeAsked) {
  const TemporaryFolder folder;
  const std::set<std::string> calls = allowed_calls(kUnit);
  ASSERT_EQ(calls.count("adjtimex") + calls.count("clock_adjtime"), 0U);
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n",
                     .setting = {.wrapper = filters(folder.path(), calls, "1,2,10")}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const nlohmann::json ready =
      nlohmann::json::parse(testing::http_body(testing::http_get(daemon.http_port(), "/readyz")));
  const bool marked = std::filesystem::exists("/run/systemd/timesync/synchronized");
  EXPECT_EQ(ready.at("clock"), marked ? "synchronised" : "unknown");
  EXPECT_EQ(ready.at("warnings"), nlohmann::json::array());
  Process status(folder.path(),
                 "status",
                 "rayloc",
                 {"status", "--http", "127.0.0.1:" + std::to_string(daemon.http_port())});
  EXPECT_EQ(status.wait(std::chrono::seconds(60)), 0) << status.errors();
  EXPECT_EQ(read_text(status.out()).find("clock: unknown") == std::string::npos, marked);
}

// The first test is worth something only if a missing call shows.
TEST_F(Seccomp, ACallThatIsMissingShows) {
  std::set<std::string> calls = allowed_calls(kUnit);
  calls.erase("recvmmsg");
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .setting = {.wrapper = filters(folder.path(), calls, "1,2,10")}});
  EXPECT_TRUE(eventually(std::chrono::seconds(30), [&] {
    return daemon.log().find("Operation not permitted") != std::string::npos;
  })) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e::seccomp_test
