// What must hold for a long time, in its short form; tests/soak/run runs the long one.
// RAYLOC_JOINS: late subscribers; RAYLOC_JOINS_RATE: datagrams a second meanwhile.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/stated.h"

namespace rayloc::e2e {
namespace {

constexpr std::chrono::seconds kPatience{60};

// Frames of several devices and of none, until the test ends.
std::vector<std::string> load(const LiveDaemon& daemon, int rate) {
  return {"send",
          bundled_recording("calibration", "ap2"),
          "--to",
          daemon.address(0),
          "--rate",
          std::to_string(rate),
          "--duration",
          "1000000"};
}

// Whether each topic's numbers follow one another; a message of its own for each that do not.
void expect_every_sequence_once(const std::vector<std::string>& lines, int join) {
  std::map<std::string, std::uint64_t> last;
  for (const std::string& line : lines) {
    const nlohmann::json envelope = nlohmann::json::parse(line);
    for (const char* const kind : {"location", "heartbeat", "source", "track"}) {
      if (!envelope.contains(kind)) {
        continue;
      }
      // As topics are: by target, by access point.
      const std::string topic =
          std::string(kind) + (kind == std::string("location")
                                   ? envelope.at(kind).at("target").at("mac").get<std::string>()
                                   : "");
      const std::uint64_t sequence = number(envelope.at("sequence"));
      if (last.count(topic) > 0) {
        EXPECT_EQ(sequence, last[topic] + 1) << topic << " of join " << join;
      }
      last[topic] = sequence;
    }
  }
}

TEST(Endurance, LateSubscribersGetEverySequenceOnce) {
  const TemporaryFolder folder;
  LiveDaemon daemon(
      folder.path(),
      {.site = bundled(""), .access_points = {"ap2"}, .more_configuration = "heartbeat_s = 0.1\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process sender(folder.path(), "send", "rayloc", load(daemon, stated("RAYLOC_JOINS_RATE", 3000)));
  ASSERT_TRUE(eventually(kPatience, [&] { return !daemon.bodies("location").empty(); }));
  const int joins = stated("RAYLOC_JOINS", 50);
  for (int join = 0; join < joins; ++join) {
    Process late(folder.path(),
                 "late",
                 "rayloc",
                 {"sub",
                  "v1/",
                  "--endpoint",
                  daemon.endpoint(),
                  "--snapshot",
                  daemon.snapshot(),
                  "--json",
                  "--count",
                  "12"});
    ASSERT_EQ(late.wait(kPatience), 0) << late.errors() << daemon.errors();
    const std::vector<std::string> lines = read_lines(late.out());
    ASSERT_EQ(lines.size(), 12U);
    expect_every_sequence_once(lines, join);
    EXPECT_EQ(late.errors(), "late.err:\n") << "it says what it lost";
  }
  std::printf("%d joins\n", joins);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e
