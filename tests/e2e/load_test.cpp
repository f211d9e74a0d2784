// Many datagrams over loopback into a real raylocd: none is lost at a rate it must stand, and every
// one that is lost in an overload is counted. RAYLOC_LOAD_SECONDS lengthens the run.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/load_tally.h"
#include "tests/e2e/numbered_sender.h"

namespace rayloc::e2e {
namespace {

constexpr std::chrono::seconds kPatience{120};
constexpr int kRate = 50'000;  // datagrams a second

int load_seconds() {
  const char* const stated = std::getenv("RAYLOC_LOAD_SECONDS");
  return stated != nullptr ? std::atoi(stated) : 3;
}

std::vector<std::string> sender_arguments(const LiveDaemon& daemon, int seconds) {
  return {"send",
          // 360 frames: more than the assembler remembers, so that none of a repetition is late.
          bundled_recording("calibration", "ap2"),
          "--to",
          daemon.address(0),
          "--rate",
          std::to_string(kRate),
          "--duration",
          std::to_string(seconds)};
}

LiveDaemonOptions one_access_point(const std::string& more) {
  return {.site = bundled(""), .access_points = {"ap2"}, .more_configuration = more};
}

TEST(Load, LosesNothingAtFiftyThousandDatagramsASecond) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), one_access_point(""));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process sender(folder.path(), "send", "rayloc", sender_arguments(daemon, load_seconds()));
  ASSERT_EQ(sender.wait(kPatience + std::chrono::seconds(load_seconds())), 0) << sender.errors();
  const Tally tally = settled(daemon);
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();

  std::printf("%d datagrams/s: %llu received, %llu lost, %llu frames, %llu of them worked on\n",
              kRate,
              static_cast<unsigned long long>(tally.received),           // NOLINT
              static_cast<unsigned long long>(tally.lost()),             // NOLINT
              static_cast<unsigned long long>(tally.frames),             // NOLINT
              static_cast<unsigned long long>(tally.frames_processed));  // NOLINT
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
  const std::filesystem::path recordings = folder.path() / "rec";
  LiveDaemon daemon(folder.path(),
                    one_access_point("[limits]\nring_frames = 16\n[record]\ndirectory = \"" +
                                     recordings.string() + "\"\n"));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process sender(folder.path(), "send", "rayloc", sender_arguments(daemon, 3));
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
  // What came is recorded whole, or the recording says how much is missing.
  const nlohmann::json recorder = daemon.bodies("heartbeat").back().at("recorder");
  EXPECT_EQ(number(recorder.at("given")), tally.received);
  EXPECT_EQ(number(recorder.at("written")) + number(recorder.at("dropped")), tally.received);
  EXPECT_EQ(number(recorder.at("in_flight")), 0U);
  const NumberedRecording recorded = read_numbered(recordings);
  EXPECT_EQ(recorded.numbers.size(), number(recorder.at("written")));
  EXPECT_EQ(recorded.unrecorded, number(recorder.at("dropped")));
  expect_conserved(tally);
  EXPECT_EQ(tally.received + tally.kernel_drops, sent_by(sender)) << "unaccounted";
}

}  // namespace
}  // namespace rayloc::e2e
