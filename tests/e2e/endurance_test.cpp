// What must hold for a long time, in its short form; tests/soak/run runs the long one.
// RAYLOC_JOINS: late subscribers; RAYLOC_JOINS_RATE: datagrams a second meanwhile.
// RAYLOC_MEMORY_SECONDS: how long memory is watched; RAYLOC_MEMORY_RATE: datagrams a second
// meanwhile.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e {
namespace {

constexpr std::chrono::seconds kPatience{60};

int stated(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : otherwise;
}

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

struct Sample {
  double seconds = 0.0;
  double rss_kib = 0.0;
  std::size_t descriptors = 0;
};

Sample sample(const LiveDaemon& daemon, std::chrono::steady_clock::time_point begin) {
  Sample sample;
  sample.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  sample.rss_kib = daemon.resident_kib();
  const std::string descriptors = "/proc/" + std::to_string(daemon.pid()) + "/fd";
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(descriptors)) {
    ++sample.descriptors;
  }
  return sample;
}

// Of a straight line through resident memory, in KiB a minute.
double slope(const std::vector<Sample>& samples) {
  double t = 0.0;
  double y = 0.0;
  for (const Sample& s : samples) {
    t += s.seconds / static_cast<double>(samples.size());
    y += s.rss_kib / static_cast<double>(samples.size());
  }
  double ty = 0.0;
  double tt = 0.0;
  for (const Sample& s : samples) {
    ty += (s.seconds - t) * (s.rss_kib - y);
    tt += (s.seconds - t) * (s.seconds - t);
  }
  return 60.0 * ty / tt;
}

TEST(Endurance, MemoryAndDescriptorsStayAsTheyAre) {
  const TemporaryFolder folder;
  // A ring that is soon full, and recordings that are soon removed.
  const std::string recordings = (folder.path() / "rec").string();
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[record]\ndirectory = \"" + recordings +
                                           "\"\nrotate_mb = 1\nmax_total_mb = 16\n"
                                           "min_free_mb = 0\nring_mb = 4\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process sender(folder.path(), "send", "rayloc", load(daemon, stated("RAYLOC_MEMORY_RATE", 5000)));
  const int seconds = stated("RAYLOC_MEMORY_SECONDS", 6);
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Sample> samples;
  // The first third fills what has a bound.
  for (int i = 0; i < seconds; ++i) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    if (i >= seconds / 3) {
      samples.push_back(sample(daemon, begin));
    }
  }
  ASSERT_GE(samples.size(), 3U);
  const auto [least, most] =
      std::minmax_element(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
        return a.rss_kib < b.rss_kib;
      });
  std::size_t descriptors = 0;
  for (const Sample& s : samples) {
    descriptors = std::max(descriptors, s.descriptors);
  }
  std::printf(
      "%d s: resident %.0f to %.0f KiB, slope %.1f KiB/min; at most %zu descriptors, %zu at "
      "the end\n",
      seconds,
      least->rss_kib,
      most->rss_kib,
      slope(samples),
      descriptors,
      samples.back().descriptors);
  EXPECT_LE(descriptors, samples.front().descriptors + 4) << "a rotation and a request are open";
  EXPECT_LT(samples.back().rss_kib, samples.front().rss_kib * 1.1 + 16 * 1024);
  std::uint64_t recorded = 0;
  for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
    std::error_code gone;
    const auto size = std::filesystem::file_size(entry.path(), gone);
    recorded += gone ? 0U : size;
  }
  EXPECT_LT(recorded, std::uint64_t{64} << 20U);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e
