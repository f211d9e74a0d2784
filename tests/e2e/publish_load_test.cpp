// Frames of CSI published as they come, by a real raylocd with nothing to locate: none is lost, no
// subscriber has a gap, and one that stops reading costs the others nothing.
//
// Rates are those of OPERATIONS (20,000 datagrams/s, 10,000 messages/s). RAYLOC_LOAD_SECONDS and
// RAYLOC_SUBSCRIBERS_SECONDS lengthen the tests; then these rates are what must hold. Unless they
// are stated, lower ones are tried where the machine is too busy. At every rate what is lost is
// counted. Time is printed, never asserted, beside what the machine does without us.
#include <csignal>
#include <cstdio>
#include <deque>

#include <gtest/gtest.h>

#include "tests/e2e/csi_reader.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/load_tally.h"
#include "tests/e2e/raw_figures.h"
#include "tests/e2e/stated.h"

namespace rayloc::e2e::publish_load_test {
namespace {

constexpr std::chrono::seconds kPatience{60};
constexpr int kSeconds = 12;  // of load at each rate, unless stated
// Messages queued for each subscriber, `publish.send_high_water_mark`. The queue holds three
// seconds of messages at 20,000 datagrams/s, so that a busy machine does not appear as a stuck
// reader; a stuck reader is tested with the default.
constexpr int kLongQueue = 20'000;
constexpr int kDefaultQueue = 5000;

LiveDaemonOptions publishing_csi(int high_water_mark) {
  return {.site = bundled(""),
          .access_points = {"ap2"},
          .more_configuration = "csi = true\nsend_high_water_mark = " +
                                std::to_string(high_water_mark) + "\n[engine]\nmethod = \"none\"\n",
          .subscriptions = {"v1/heartbeat/"}};
}

// The last heartbeat's `publisher`.
nlohmann::json publisher_of(const LiveDaemon& daemon) {
  return daemon.bodies("heartbeat").back().at("publisher");
}

bool subscribed(const LiveDaemon& daemon, std::uint64_t subscriptions) {
  return eventually(
      kPatience, [&] { return number(publisher_of(daemon).at("subscriptions")) >= subscriptions; });
}

// Sends for a while; how many datagrams.
std::uint64_t send_at(const std::filesystem::path& folder,
                      const LiveDaemon& daemon,
                      int rate,
                      int seconds) {
  Process sender(folder,
                 "send",
                 "rayloc",
                 {"send",
                  bundled_recording("calibration", "ap2"),
                  "--to",
                  daemon.address(0),
                  "--rate",
                  std::to_string(rate),
                  "--duration",
                  std::to_string(seconds)});
  EXPECT_EQ(sender.wait(std::chrono::seconds{120 + seconds}), 0) << sender.errors();
  return sent_by(sender);
}

// Each frame reached the reader or its loss is counted, here or as a gap at the reader. Dropped
// ones of all are returned.
std::uint64_t expect_every_frame(const LiveDaemon& daemon,
                                 const CsiReader& reader,
                                 const Tally& tally) {
  std::uint64_t dropped = 0;
  eventually(kPatience, [&] {
    dropped = number(publisher_of(daemon).at("csi_dropped"));
    return reader.messages() + reader.lost() + dropped >= tally.frames;
  });
  EXPECT_EQ(reader.messages() + reader.lost() + dropped, tally.frames)
      << "unaccounted: " << reader.messages() << " read, " << reader.lost() << " lost, " << dropped
      << " dropped";
  return dropped;
}

TEST(PublishLoad, EveryDatagramBecomesAPublishedFrameAndNoneIsLost) {
  const int seconds = stated("RAYLOC_LOAD_SECONDS", kSeconds);
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), publishing_csi(kLongQueue));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const CsiReader reader(daemon.endpoint());
  ASSERT_TRUE(subscribed(daemon, 3));
  std::printf(
      "%d s a rate, send_high_water_mark = %d (default %d)\n", seconds, kLongQueue, kDefaultQueue);
  std::uint64_t sent = 0;
  Tally before;
  std::uint64_t dropped = 0;
  bool lossless = false;
  for (const int rate : rates_of("RAYLOC_LOAD_SECONDS", 20'000)) {
    const std::uint64_t read_before = reader.messages();
    const std::uint64_t lost_before = reader.lost() + reader.others_lost() + dropped;
    const std::uint64_t now = send_at(folder.path(), daemon, rate, seconds);
    sent += now;
    const Tally after = accounted(daemon, sent);
    dropped = expect_every_frame(daemon, reader, after);
    const std::uint64_t gaps = reader.lost() + reader.others_lost() + dropped - lost_before;
    const std::uint64_t frames = after.frames - before.frames;
    std::printf(
        "%d datagrams/s: %llu sent, %llu lost, %llu frames, %llu published, %llu gaps; datagram "
        "to publish p50 %.2f ms, p99 %.2f ms\n",
        rate,
        static_cast<unsigned long long>(now),                              // NOLINT
        static_cast<unsigned long long>(after.lost() - before.lost()),     // NOLINT
        static_cast<unsigned long long>(frames),                           // NOLINT
        static_cast<unsigned long long>(reader.messages() - read_before),  // NOLINT
        static_cast<unsigned long long>(gaps),                             // NOLINT
        reader.latency_ms(0.5, frames),
        reader.latency_ms(0.99, frames));
    lossless = after.lost() == before.lost() && gaps == 0;
    before = after;
    if (lossless) {
      break;
    }
  }
  EXPECT_TRUE(lossless) << "at no rate that counts";
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  print_recvmmsg_alone();
  print_xpub_alone(kLongQueue);
}

TEST(PublishLoad, OneStoppedSubscriberCostsTheOtherFourNothing) {
  const int seconds = stated("RAYLOC_SUBSCRIBERS_SECONDS", kSeconds);
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), publishing_csi(kDefaultQueue));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::deque<CsiReader> readers;
  for (int i = 0; i < 4; ++i) {
    readers.emplace_back(daemon.endpoint());
  }
  Process stopped(
      folder.path(), "stopped", "rayloc", {"sub", "v1/csi/", "--endpoint", daemon.endpoint()});
  ASSERT_TRUE(subscribed(daemon, 10));
  stopped.signal(SIGSTOP);
  std::printf("%d s a rate, send_high_water_mark = %d (the default)\n", seconds, kDefaultQueue);
  std::uint64_t sent = 0;
  std::uint64_t lost_before = 0;
  Tally before;
  bool lossless = false;
  for (const int rate : rates_of("RAYLOC_SUBSCRIBERS_SECONDS", 30'000)) {
    sent += send_at(folder.path(), daemon, rate, seconds);
    const Tally after = accounted(daemon, sent);
    std::uint64_t lost = 0;
    std::uint64_t dropped = 0;
    for (const CsiReader& reader : readers) {
      dropped = expect_every_frame(daemon, reader, after);
      lost += reader.lost() + reader.others_lost();
    }
    std::printf(
        "%d messages/s to five, one stopped: %llu messages, %llu lost by the other four; %llu of "
        "all lost before they were published\n",
        rate / 3,                                                       // three cores a frame
        static_cast<unsigned long long>(after.frames - before.frames),  // NOLINT
        static_cast<unsigned long long>(lost - lost_before),            // NOLINT
        static_cast<unsigned long long>(after.lost() - before.lost() + dropped));  // NOLINT
    // A message that was never published is not one of 10,000 a second.
    lossless = lost == lost_before && after.lost() == before.lost() && dropped == 0;
    lost_before = lost;
    before = after;
    if (lossless) {
      break;
    }
  }
  EXPECT_TRUE(lossless) << "at no rate that counts";
  EXPECT_GT(number(publisher_of(daemon).at("slow_episodes")), 0U) << "nobody was slow";
  stopped.signal(SIGKILL);
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  print_recvmmsg_alone();
  print_xpub_alone(kDefaultQueue);
}

}  // namespace
}  // namespace rayloc::e2e::publish_load_test
