// Many datagrams over loopback into a real raylocd: none is lost at a rate it must stand, and every
// one that is lost in an overload is counted. RAYLOC_LOAD_SECONDS lengthens the run.
#include <csignal>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e {
namespace {

constexpr std::chrono::seconds kPatience{120};
constexpr int kRate = 50'000;  // datagrams a second

std::string load_seconds() {
  const char* const stated = std::getenv("RAYLOC_LOAD_SECONDS");
  return stated != nullptr ? stated : "3";
}

std::vector<std::string> sender_arguments(const LiveDaemon& daemon, const std::string& seconds) {
  return {"send",
          // 360 frames: more than the assembler remembers, so that none of a repetition is late.
          bundled_recording("calibration", "ap2"),
          "--to",
          daemon.address(0),
          "--rate",
          std::to_string(kRate),
          "--duration",
          seconds};
}

// Of the line that ends what the sender says: {"event":"end","datagrams":150000,...}.
std::uint64_t sent_by(const Process& sender) {
  for (const std::string& line : read_lines(sender.out())) {
    const nlohmann::json event = nlohmann::json::parse(line, nullptr, false);
    if (event.is_object() && event.value("event", "") == "end") {
      return event.at("datagrams").get<std::uint64_t>();
    }
  }
  ADD_FAILURE() << "the sender did not say how many\n" << sender.errors();
  return 0;
}

struct Tally {
  std::uint64_t received = 0;
  std::uint64_t rejected = 0;
  std::uint64_t kernel_drops = 0;
  std::uint64_t ring_dropped = 0;
  std::uint64_t processed = 0;
  std::uint64_t in_flight = 0;
  std::uint64_t frames = 0;
  std::uint64_t frames_dropped = 0;
  std::uint64_t frames_processed = 0;
  std::uint64_t frames_in_flight = 0;

  std::uint64_t lost() const { return rejected + kernel_drops + ring_dropped + frames_dropped; }
};

Tally tally_of(const nlohmann::json& heartbeat) {
  const nlohmann::json& c = heartbeat.at("sources").at(0).at("counters");
  Tally tally;
  tally.received = number(c.at("received"));
  for (const auto& [reason, count] : c.at("rejected").items()) {
    tally.rejected += number(count);
  }
  tally.kernel_drops = number(c.at("kernel_drops"));
  tally.ring_dropped = number(c.at("ring_dropped"));
  tally.processed = number(c.at("processed"));
  tally.in_flight = number(c.at("in_flight"));
  tally.frames = number(c.at("frames_complete")) + number(c.at("frames_partial"));
  tally.frames_dropped = number(c.at("frames_dropped"));
  tally.frames_processed = number(c.at("frames_processed"));
  tally.frames_in_flight = number(c.at("frames_in_flight"));
  return tally;
}

void expect_conserved(const Tally& t) {
  EXPECT_EQ(t.received, t.rejected + t.ring_dropped + t.processed + t.in_flight);
  EXPECT_EQ(t.frames, t.frames_dropped + t.frames_processed + t.frames_in_flight);
}

// The counters once nothing is on its way any more; those of the last heartbeat when that does
// not come.
Tally settled(const LiveDaemon& daemon) {
  Tally last;
  eventually(std::chrono::seconds{30}, [&] {
    const std::vector<nlohmann::json> heartbeats = daemon.bodies("heartbeat");
    if (heartbeats.size() < 2) {
      return false;
    }
    const Tally before = tally_of(heartbeats[heartbeats.size() - 2]);
    last = tally_of(heartbeats.back());
    return last.received > 0 && before.received == last.received && last.in_flight == 0 &&
           last.frames_in_flight == 0;
  });
  return last;
}

LiveDaemonOptions one_access_point(const std::string& more) {
  return {.site = bundled(""), .access_points = {"ap2"}, .more_configuration = more};
}

TEST(Load, LosesNothingAtFiftyThousandDatagramsASecond) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), one_access_point(""));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process sender(folder.path(), "send", "rayloc", sender_arguments(daemon, load_seconds()));
  ASSERT_EQ(sender.wait(kPatience), 0) << sender.errors();
  const Tally tally = settled(daemon);
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();

  expect_conserved(tally);
  EXPECT_EQ(tally.received + tally.kernel_drops, sent_by(sender)) << "unaccounted";
  EXPECT_EQ(tally.lost(), 0U) << "rejected " << tally.rejected << ", kernel " << tally.kernel_drops
                              << ", ring " << tally.ring_dropped << ", frames "
                              << tally.frames_dropped;
  EXPECT_EQ(tally.in_flight, 0U);
  // Three cores make a frame. Where the recording begins again, a few frames meet the memory of
  // those with the same counter and are late; the load is real only if most are not.
  EXPECT_GT(tally.frames * 3, tally.received / 10 * 9);
}

TEST(Load, CountsEveryLossOfAnOverload) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), one_access_point("[limits]\nring_frames = 16\n"));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process sender(folder.path(), "send", "rayloc", sender_arguments(daemon, "3"));
  // A daemon that does not run for a second lets the kernel's queue overflow; afterwards the 16
  // frames that may wait are far too few for what comes at once.
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  daemon.signal(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  daemon.signal(SIGCONT);
  ASSERT_EQ(sender.wait(kPatience), 0) << sender.errors();
  const Tally tally = settled(daemon);
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();

  EXPECT_GT(tally.kernel_drops, 0U);
  EXPECT_GT(tally.frames_dropped, 0U);
  expect_conserved(tally);
  EXPECT_EQ(tally.received + tally.kernel_drops, sent_by(sender)) << "unaccounted";
}

}  // namespace
}  // namespace rayloc::e2e
