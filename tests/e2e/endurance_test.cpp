// Subscribers that come late, under load, in short; tests/soak/run joins has the full count.
// RAYLOC_JOINS: how many; RAYLOC_JOINS_RATE: datagrams a second meanwhile.
#include <cstdio>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "daemon/live/publish/late_subscriber.h"
#include "daemon/messages/gap_detector.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/e2e/device_recording.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/stated.h"
#include "tests/support/patience.h"

namespace rayloc::e2e::endurance_test {
namespace {

constexpr std::chrono::seconds kPatience{60};
constexpr int kDevices = 40;  // each has a topic of its own
constexpr int kFirst = 0x10;  // the last byte of the first one's address: none that the site names
constexpr int kRead = 100;    // messages of each that comes late, frames of CSI aside
// One of so many is `rayloc sub`, a process of its own, which reads so many messages of any kind.
constexpr int kEachIsAProcess = 10;
constexpr int kReadByProcess = 300;

// Frames of many devices, until the test ends.
std::vector<std::string> load(const LiveDaemon& daemon, const std::string& recording, int rate) {
  return {"send",
          recording,
          "--to",
          daemon.address(0),
          "--rate",
          std::to_string(rate),
          "--duration",
          "1000000"};
}

struct JoinTally {
  std::set<std::string> topics;  // that a snapshot must contain: published before, CSI aside
  std::uint64_t snapshots = 0;   // messages of snapshots
  std::uint64_t live = 0;        // other messages
};

// A late subscriber: the snapshot contains every topic that had been published before, and then the
// numbers of each topic are consecutive, from that of the snapshot on.
void join(const LiveDaemon& daemon, JoinTally& tally) {
  auto late =
      LateSubscriber::join(daemon.endpoint(), daemon.snapshot(), {"v1/"}, test::patient(kPatience));
  ASSERT_TRUE(late) << late.error().message;
  std::map<std::string, std::uint64_t> last;
  std::set<std::string> missing = tally.topics;
  GapDetector gaps;
  for (int read = 0; read < kRead;) {
    const auto message = late->receive(test::patient(kPatience));
    ASSERT_TRUE(message) << "nothing after " << read;
    v1::Envelope envelope;
    ASSERT_TRUE(envelope.ParseFromString(message->payload)) << message->topic;
    gaps.add(message->topic, envelope);
    missing.erase(message->topic);
    const auto [topic, first] = last.try_emplace(message->topic, envelope.sequence());
    if (!first) {
      EXPECT_FALSE(message->from_snapshot) << message->topic;
      EXPECT_EQ(envelope.sequence(), topic->second + 1) << message->topic;
      topic->second = envelope.sequence();
    } else if (!envelope.has_csi()) {
      EXPECT_TRUE(message->from_snapshot || envelope.sequence() == 1)
          << message->topic << " begins with " << envelope.sequence();
      tally.topics.insert(message->topic);
    }
    read += envelope.has_csi() ? 0 : 1;
    (message->from_snapshot ? tally.snapshots : tally.live) += 1;
  }
  EXPECT_TRUE(missing.empty()) << missing.size() << " topics, for one " << *missing.begin();
  EXPECT_EQ(gaps.lost(), 0U);
  EXPECT_EQ(late->malformed(), 0U);
}

// Checks that the numbers of each topic are consecutive in the output of `rayloc sub --json`.
void expect_every_sequence_once(const std::vector<std::string>& lines) {
  std::map<std::string, std::uint64_t> last;
  for (const std::string& line : lines) {
    const nlohmann::json envelope = nlohmann::json::parse(line);
    for (const char* const kind : {"location", "heartbeat", "source", "track", "csi"}) {
      if (!envelope.contains(kind)) {
        continue;
      }
      // As topics are: by target; of one access point.
      const nlohmann::json& body = envelope.at(kind);
      const std::string topic =
          kind + (body.contains("target") ? body.at("target").at("mac").get<std::string>() : "");
      const std::uint64_t sequence = number(envelope.at("sequence"));
      if (last.count(topic) > 0) {
        EXPECT_EQ(sequence, last[topic] + 1) << topic;
      }
      last[topic] = sequence;
    }
  }
}

void join_as_a_process(const LiveDaemon& daemon, const std::filesystem::path& folder) {
  Process late(folder,
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
                std::to_string(kReadByProcess)});
  ASSERT_EQ(late.wait(kPatience), 0) << late.errors() << daemon.errors();
  const std::vector<std::string> lines = read_lines(late.out());
  ASSERT_EQ(lines.size(), static_cast<std::size_t>(kReadByProcess));
  expect_every_sequence_once(lines);
  EXPECT_EQ(late.errors(), "late.err:\n") << "it says what it lost";
}

TEST(Endurance, LateSubscribersGetEverySequenceOnce) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "csi = true\nheartbeat_s = 0.1\n",
                     .subscriptions = {"v1/heartbeat/"}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  Process sender(folder.path(),
                 "send",
                 "rayloc",
                 load(daemon,
                      recording_of_devices(folder.path(), "ap2", kFirst, kDevices),
                      stated("RAYLOC_JOINS_RATE", 3000)));
  JoinTally tally;
  // Until every device has been located, the snapshot grows.
  ASSERT_TRUE(eventually(kPatience,
                         [&] {
                           join(daemon, tally);
                           return HasFatalFailure() || tally.topics.size() >= kDevices + 2;
                         }))
      << tally.topics.size() << " topics";
  const int joins = stated("RAYLOC_JOINS", 50);
  for (int i = 0; i < joins && !HasFatalFailure(); ++i) {
    SCOPED_TRACE("join " + std::to_string(i));
    if (i % kEachIsAProcess == 0) {
      join_as_a_process(daemon, folder.path());
    } else {
      join(daemon, tally);
    }
  }
  std::printf("%d joins: %zu topics, %llu messages of snapshots, %llu others\n",
              joins,
              tally.topics.size(),
              static_cast<unsigned long long>(tally.snapshots),  // NOLINT(google-runtime-int)
              static_cast<unsigned long long>(tally.live));      // NOLINT(google-runtime-int)
  EXPECT_TRUE(sender.running()) << sender.errors();
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e::endurance_test
