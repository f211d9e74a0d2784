// Many datagrams over loopback into a real raylocd: none is lost at a rate that it must sustain,
// and every loss in an overload is counted. RAYLOC_INGEST_SECONDS lengthens the run, and then that
// rate must hold; otherwise lower rates are tried on a machine that is too busy for it.
#include <csignal>
#include <cstdio>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/load_tally.h"
#include "tests/e2e/numbered_sender.h"
#include "tests/e2e/stated.h"

namespace rayloc::e2e::load_test {
namespace {

constexpr std::chrono::seconds kPatience{120};
constexpr int kRate = 50'000;  // datagrams a second
constexpr int kSeconds = 12;   // at each rate, unless stated

std::vector<std::string> sender_arguments(const LiveDaemon& daemon, int rate, int seconds) {
  return {"send",
          // 360 frames: more than the assembler remembers, so that none of a repetition is late.
          bundled_recording("calibration", "ap2"),
          "--to",
          daemon.address(0),
          "--rate",
          std::to_string(rate),
          "--duration",
          std::to_string(seconds)};
}

LiveDaemonOptions one_access_point(const std::string& more) {
  return {.site = bundled(""), .access_points = {"ap2"}, .more_configuration = more};
}

TEST(Load, LosesNothingAtFiftyThousandDatagramsASecond) {
  const int seconds = stated("RAYLOC_INGEST_SECONDS", kSeconds);
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), one_access_point(""));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::uint64_t sent = 0;
  Tally before;
  bool lossless = false;
  for (const int rate : rates_of("RAYLOC_INGEST_SECONDS", kRate)) {
    Process sender(folder.path(), "send", "rayloc", sender_arguments(daemon, rate, seconds));
    ASSERT_EQ(sender.wait(kPatience + std::chrono::seconds(seconds)), 0) << sender.errors();
    sent += sent_by(sender);
    const Tally after = accounted(daemon, sent);
    const std::uint64_t received = after.received - before.received;
    const std::uint64_t frames = after.frames - before.frames;
    std::printf(
        "%d datagrams/s for %d s: %llu received; lost: rejected %llu, kernel %llu, ring %llu, "
        "frames %llu; %llu frames\n",
        rate,
        seconds,
        static_cast<unsigned long long>(received),                                      // NOLINT
        static_cast<unsigned long long>(after.rejected - before.rejected),              // NOLINT
        static_cast<unsigned long long>(after.kernel_drops - before.kernel_drops),      // NOLINT
        static_cast<unsigned long long>(after.ring_dropped - before.ring_dropped),      // NOLINT
        static_cast<unsigned long long>(after.frames_dropped - before.frames_dropped),  // NOLINT
        static_cast<unsigned long long>(frames));                                       // NOLINT
    lossless = after.lost() == before.lost();
    before = after;
    if (lossless) {
      // Three cores make a frame. Where the recording begins again, a few frames meet the memory
      // of those with the same counter and are late; the load is real only if most are not.
      EXPECT_GT(frames * 3, received / 10 * 9);
      break;
    }
  }
  EXPECT_TRUE(lossless) << "at no rate that counts";
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

// Datagrams that the kernel has dropped at a bound port of this machine.
std::uint64_t dropped_by_kernel(const std::string& address) {
  std::ostringstream port;
  port << ':' << std::uppercase << std::hex << std::setw(4) << std::setfill('0')
       << std::stoi(address.substr(address.rfind(':') + 1));
  for (const std::string& line : read_lines("/proc/net/udp")) {
    std::istringstream text(line);
    const std::vector<std::string> words{std::istream_iterator<std::string>(text), {}};
    if (words.size() > 2 && words[1].ends_with(port.str())) {
      return std::stoull(words.back());
    }
  }
  return 0;
}

TEST(Load, CountsEveryLossOfAnOverload) {
  const TemporaryFolder folder;
  const std::filesystem::path recordings = folder.path() / "rec";
  LiveDaemon daemon(folder.path(),
                    one_access_point("[limits]\nring_frames = 16\n[record]\ndirectory = \"" +
                                     recordings.string() + "\"\n"));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  // A daemon that does not run lets the kernel's queue overflow; afterwards the 16 frames that may
  // wait are far too few for what comes at once.
  daemon.signal(SIGSTOP);
  // At a slower rate it sends as many datagrams: several times what the queue holds.
  Process sender(
      folder.path(), "send", "rayloc", sender_arguments(daemon, kRate / slower(), 3 * slower()));
  const bool overflows =
      eventually(kPatience, [&] { return dropped_by_kernel(daemon.address(0)) > 0; });
  daemon.signal(SIGCONT);
  EXPECT_TRUE(overflows);
  ASSERT_EQ(sender.wait(kPatience), 0) << sender.errors();
  const Tally tally = settled(daemon);
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();

  EXPECT_GT(tally.kernel_drops, 0U);
  EXPECT_GT(tally.frames_dropped, 0U);
  // All received datagrams are recorded, or the recording states how many are missing.
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
}  // namespace rayloc::e2e::load_test
