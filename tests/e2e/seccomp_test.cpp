// raylocd under the filters of deploy/units/raylocd.service: it starts, hears, records, publishes
// and stops. A library that needs a call the unit denies shows here and not at the operator's.
#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e {
namespace {

using ::testing::HasSubstr;

const char* const kUnit = RAYLOC_TEST_DATA "/../../deploy/units/raylocd.service";

// Those that the script allowed_calls makes of the unit.
std::set<std::string> allowed_calls() {
  std::set<std::string> allowed;
  FILE* const pipe =
      popen((RAYLOC_TEST_DATA "/../e2e/allowed_calls " + std::string(kUnit)).c_str(), "r");
  std::array<char, 256> line{};
  while (fgets(line.data(), line.size(), pipe) != nullptr) {
    allowed.emplace(line.data(), std::strcspn(line.data(), "\n"));
  }
  EXPECT_EQ(pclose(pipe), 0);
  return allowed;
}

std::filesystem::path write_calls(const std::filesystem::path& folder,
                                  const std::set<std::string>& calls) {
  std::filesystem::path list = folder / "calls";
  std::ofstream file(list);
  for (const std::string& call : calls) {
    file << call << '\n';
  }
  return list;
}

// A daemon with a recorder under the unit's filters, and a second of datagrams.
void expect_works_with(const std::set<std::string>& calls, const std::string& families) {
  const TemporaryFolder folder;
  const std::filesystem::path list = write_calls(folder.path(), calls);
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""),
       .access_points = {"ap2"},
       .more_configuration = "[record]\ndirectory = \"" + (folder.path() / "rec").string() + "\"\n",
       .setting = {.wrapper = {RAYLOC_BIN "/seccomp_launcher", list.string(), families}}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_FALSE(daemon.bodies("location").empty()) << daemon.errors();
  EXPECT_EQ(number(daemon.bodies("heartbeat").back().at("recorder").at("written")), 2000U);
}

TEST(Seccomp, TheDaemonWorksUnderTheFiltersOfItsUnit) {
  const std::set<std::string> calls = allowed_calls();
  ASSERT_GT(calls.size(), 200U);
  EXPECT_EQ(calls.count("mount") + calls.count("sched_setaffinity") + calls.count("ptrace"), 0U);
  EXPECT_THAT(read_text(kUnit), HasSubstr("RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6\n"));
  expect_works_with(calls, "1,2,10");
}

// The test above is worth something only if a missing call shows.
TEST(Seccomp, ACallThatIsMissingShows) {
  std::set<std::string> calls = allowed_calls();
  calls.erase("recvmmsg");
  const TemporaryFolder folder;
  const std::filesystem::path list = write_calls(folder.path(), calls);
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""),
       .access_points = {"ap2"},
       .setting = {.wrapper = {RAYLOC_BIN "/seccomp_launcher", list.string(), "1,2,10"}}});
  EXPECT_TRUE(eventually(std::chrono::seconds(30), [&] {
    return daemon.log().find("Operation not permitted") != std::string::npos;
  })) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e
