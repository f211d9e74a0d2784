// Frames of CSI published as they come, by a real raylocd with nothing to locate: none is lost, no
// subscriber has a gap, and one that stops reading costs the others nothing.
//
// Rates are those of OPERATIONS (20,000 datagrams/s, 10,000 messages/s); where the machine is too
// busy for them the test tries lower ones, and prints what it reached beside what the machine does
// without us. RAYLOC_LOAD_SECONDS and RAYLOC_SUBSCRIBERS_SECONDS lengthen the tests. Time is
// printed, never asserted.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <thread>

#include <gtest/gtest.h>

#include "daemon/publish/gap_detector.h"
#include "daemon/publish/proto_time.h"
#include "daemon/publish/publisher.h"
#include "daemon/publish/subscriber.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/e2e/live_daemon.h"
#include "tests/e2e/load_tally.h"

namespace rayloc::e2e {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::seconds kPatience{60};
constexpr auto kRawFigure = 1s;  // how long a raw figure is measured

// A subscriber of frames, on a thread of its own. Heartbeats tell it what was lost at the end.
class Reader {
 public:
  explicit Reader(const std::string& endpoint)
      : subscriber_(std::move(*Subscriber::connect(endpoint, {"v1/csi/", "v1/heartbeat/"}))),
        thread_([this] { run(); }) {}
  ~Reader() {
    stopping_ = true;
    thread_.join();
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  std::uint64_t messages() const { return messages_; }
  std::uint64_t lost() const { return lost_; }
  // Between arrival of a frame's first datagram and its publication, of the newest `count` [ms].
  double latency_ms(double quantile, std::size_t count) const {
    const std::lock_guard lock(mutex_);
    std::vector<double> newest(
        latencies_.end() - static_cast<std::ptrdiff_t>(std::min(count, latencies_.size())),
        latencies_.end());
    if (newest.empty()) {
      return 0.0;
    }
    std::sort(newest.begin(), newest.end());
    return newest[static_cast<std::size_t>(quantile * static_cast<double>(newest.size() - 1))];
  }

 private:
  void run() {
    GapDetector gaps;
    v1::Envelope envelope;
    while (!stopping_) {
      const auto message = subscriber_.receive(50ms);
      if (!message || !envelope.ParseFromString(message->payload)) {
        continue;
      }
      gaps.add(message->topic, envelope);
      lost_ = gaps.lost();
      if (!envelope.has_csi()) {
        continue;
      }
      const Duration latency = from_proto(envelope.sent()) - from_proto(envelope.csi().time());
      {
        const std::lock_guard lock(mutex_);
        latencies_.push_back(to_seconds(latency) * 1e3);
      }
      ++messages_;
    }
  }

  Subscriber subscriber_;
  mutable std::mutex mutex_;
  std::deque<double> latencies_;  // guarded by mutex_; [ms]
  std::atomic<std::uint64_t> messages_ = 0;
  std::atomic<std::uint64_t> lost_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

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
                      double seconds) {
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
  EXPECT_EQ(sender.wait(std::chrono::seconds{120} + std::chrono::seconds(std::lround(seconds))), 0)
      << sender.errors();
  return sent_by(sender);
}

// The tally once every datagram that was sent is accounted for and every frame has been published.
Tally accounted(const LiveDaemon& daemon, std::uint64_t sent) {
  EXPECT_TRUE(eventually(kPatience, [&] {
    const Tally tally = tally_of(daemon.bodies("heartbeat").back());
    return tally.received + tally.kernel_drops == sent;
  })) << "unaccounted";
  const Tally tally = settled(daemon);
  expect_conserved(tally);
  return tally;
}

// Datagrams a second over loopback by recvmmsg(2) with nothing behind it.
void print_recvmmsg_alone() {
  const int receiver = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int sender = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int buffer = 8 << 20;
  setsockopt(receiver, SOL_SOCKET, SO_RCVBUFFORCE, &buffer, sizeof buffer);
  const timeval wait{0, 50'000};
  setsockopt(receiver, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(receiver, reinterpret_cast<sockaddr*>(&address), size), 0);
  getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &size);
  ASSERT_EQ(connect(sender, reinterpret_cast<sockaddr*>(&address), size), 0);

  constexpr std::size_t kBatch = 64;
  std::vector<std::array<char, 1100>> bytes(2 * kBatch);
  std::vector<iovec> parts(2 * kBatch);
  std::vector<mmsghdr> messages(2 * kBatch);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    parts[i] = {bytes[i].data(), bytes[i].size()};
    messages[i].msg_hdr.msg_iov = &parts[i];
    messages[i].msg_hdr.msg_iovlen = 1;
  }
  std::atomic<std::uint64_t> sent = 0;
  std::uint64_t received = 0;
  const auto end = std::chrono::steady_clock::now() + kRawFigure;
  std::thread sending([&] {
    while (std::chrono::steady_clock::now() < end) {
      const int now = sendmmsg(sender, messages.data(), kBatch, 0);
      sent += now > 0 ? static_cast<std::uint64_t>(now) : 0U;
    }
  });
  while (true) {
    const int now = recvmmsg(receiver, messages.data() + kBatch, kBatch, MSG_WAITFORONE, nullptr);
    if (now <= 0) {
      break;
    }
    received += static_cast<std::uint64_t>(now);
  }
  sending.join();
  close(receiver);
  close(sender);
  std::printf("recvmmsg alone: %llu datagrams/s received of %llu/s sent\n",
              static_cast<unsigned long long>(received),      // NOLINT(google-runtime-int)
              static_cast<unsigned long long>(sent.load()));  // NOLINT(google-runtime-int)
}

// Messages a second by a publisher of ours in this process to five subscribers, with nothing
// before it.
void print_xpub_alone(int values) {
  PublisherOptions options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.site = "alone";
  options.epoch = 1;
  auto publisher = Publisher::bind(options);
  ASSERT_TRUE(publisher) << publisher.error().message;
  std::deque<Reader> readers;
  for (int i = 0; i < 5; ++i) {
    readers.emplace_back(publisher->endpoint());
  }
  ASSERT_TRUE(eventually(kPatience, [&] { return publisher->counters().subscriptions == 10; }));
  v1::CsiFrame frame;
  frame.set_ap("ap");
  for (int i = 0; i < values; ++i) {
    frame.add_csi(1.0F);
  }
  const auto end = std::chrono::steady_clock::now() + kRawFigure;
  std::uint64_t published = 0;
  for (; std::chrono::steady_clock::now() < end; ++published) {
    publisher->publish(frame, Timestamp{});
  }
  std::uint64_t received = 0;
  for (const Reader& reader : readers) {
    received += reader.messages();
  }
  std::printf("XPUB alone: %llu messages/s published, %llu/s received by five\n",
              static_cast<unsigned long long>(published),  // NOLINT(google-runtime-int)
              static_cast<unsigned long long>(received));  // NOLINT(google-runtime-int)
}

TEST(PublishLoad, EveryDatagramBecomesAPublishedFrameAndNoneIsLost) {
  const char* const stated = std::getenv("RAYLOC_LOAD_SECONDS");
  const double seconds = stated != nullptr ? std::stod(stated) : 3.0;
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), publishing_csi(20'000));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  const Reader reader(daemon.endpoint());
  ASSERT_TRUE(subscribed(daemon, 3));
  std::uint64_t sent = 0;
  Tally before;
  std::uint64_t dropped_before = 0;
  bool lossless = false;
  for (int rate = 20'000; rate >= 1250 && !lossless; rate /= 2) {
    const std::uint64_t read_before = reader.messages();
    const std::uint64_t lost_before = reader.lost();
    const std::uint64_t now = send_at(folder.path(), daemon, rate, seconds);
    sent += now;
    const Tally after = accounted(daemon, sent);
    const std::uint64_t frames = after.frames - before.frames;
    const std::uint64_t csi_dropped = number(publisher_of(daemon).at("csi_dropped"));
    // A frame is published, or its loss is counted: here, or as a gap at the subscriber.
    EXPECT_TRUE(eventually(
        kPatience, [&] { return reader.messages() + reader.lost() + csi_dropped >= after.frames; }))
        << reader.messages() << " of " << after.frames;
    lossless = after.lost() == before.lost() && reader.lost() == lost_before &&
               csi_dropped == dropped_before;
    dropped_before = csi_dropped;
    std::printf(
        "%d datagrams/s: %llu sent, %llu lost, %llu frames, %llu published, %llu gaps; datagram "
        "to publish p50 %.2f ms, p99 %.2f ms\n",
        rate,
        static_cast<unsigned long long>(now),                              // NOLINT
        static_cast<unsigned long long>(after.lost() - before.lost()),     // NOLINT
        static_cast<unsigned long long>(frames),                           // NOLINT
        static_cast<unsigned long long>(reader.messages() - read_before),  // NOLINT
        static_cast<unsigned long long>(reader.lost() - lost_before),      // NOLINT
        reader.latency_ms(0.5, frames),
        reader.latency_ms(0.99, frames));
    before = after;
  }
  EXPECT_TRUE(lossless) << "at no rate";
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  print_recvmmsg_alone();
}

TEST(PublishLoad, OneStoppedSubscriberCostsTheOtherFourNothing) {
  const char* const stated = std::getenv("RAYLOC_SUBSCRIBERS_SECONDS");
  const double datagrams = 30'000 * (stated != nullptr ? std::stod(stated) : 2.0);
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), publishing_csi(1000));
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::deque<Reader> readers;
  for (int i = 0; i < 4; ++i) {
    readers.emplace_back(daemon.endpoint());
  }
  Process stopped(
      folder.path(), "stopped", "rayloc", {"sub", "v1/csi/", "--endpoint", daemon.endpoint()});
  ASSERT_TRUE(subscribed(daemon, 10));
  stopped.signal(SIGSTOP);
  std::uint64_t sent = 0;
  std::uint64_t lost_before = 0;
  bool lossless = false;
  std::uint64_t frames_before = 0;
  for (int rate = 30'000; rate >= 7500 && !lossless; rate /= 2) {
    sent += send_at(folder.path(), daemon, rate, datagrams / rate);
    const Tally tally = accounted(daemon, sent);
    std::uint64_t lost = 0;
    for (const Reader& reader : readers) {
      EXPECT_TRUE(eventually(kPatience, [&] {
        return reader.messages() + reader.lost() + number(publisher_of(daemon).at("csi_dropped")) >=
               tally.frames;
      }));
      lost += reader.lost();
    }
    lossless = lost == lost_before;
    lost_before = lost;
    std::printf("%d messages/s to five, one stopped: %llu messages, %llu lost by the other four\n",
                rate / 3,  // three cores a frame
                static_cast<unsigned long long>(tally.frames - frames_before),  // NOLINT
                static_cast<unsigned long long>(lost));                         // NOLINT
    frames_before = tally.frames;
  }
  EXPECT_TRUE(lossless) << "at no rate";
  EXPECT_GT(number(publisher_of(daemon).at("slow_episodes")), 0U) << "nobody was slow";
  stopped.signal(SIGKILL);
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  print_xpub_alone(3 * 128 * 2);
}

}  // namespace
}  // namespace rayloc::e2e
