// Publishes locations of 20 devices at a steady rate, for the tests of the clients.
//   burst_publisher MESSAGES RATE SUBSCRIPTIONS
// Prints the endpoints of publisher and snapshots, waits for that many subscriptions, sends
// MESSAGES (0: until its standard input closes) at RATE a second with a heartbeat every 500, sends
// a goodbye and prints how many locations it sent in how many seconds.
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "daemon/live/publish/publisher.h"
#include "daemon/live/publish/snapshot_server.h"
#include "daemon/messages/last_messages.h"
#include "rayloc/v1/heartbeat.pb.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kDevices = 20;
constexpr std::uint64_t kHeartbeatEvery = 500;
constexpr int kHypotheses = 5;

struct Plan {
  std::uint64_t messages = 0;
  double rate = 0.0;  // [1/s]
  std::uint64_t subscriptions = 0;
};

Timestamp now() {
  return std::chrono::time_point_cast<Timestamp::duration>(std::chrono::system_clock::now());
}

// A location with the size of a real one.
v1::Location location_of(std::uint64_t device) {
  v1::Location location;
  location.set_kind(v1::LOCATION_KIND_FILTERED);
  location.set_mode(v1::FIX_MODE_2D);
  location.mutable_target()->set_kind(v1::TARGET_KIND_DEVICE);
  location.mutable_target()->set_mac("02:00:00:00:00:" + std::to_string(10 + device));
  location.mutable_position()->set_x(static_cast<double>(device));
  for (int i = 0; i < kHypotheses; ++i) {
    v1::Hypothesis& hypothesis = *location.add_hypotheses();
    hypothesis.mutable_position()->set_x(static_cast<double>(i));
    for (int value = 0; value < 9; ++value) {
      hypothesis.add_position_covariance(0.01 * value);
    }
    hypothesis.set_weight(0.2);
  }
  return location;
}

bool input_closed() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char byte = 0;
  return ::poll(&input, 1, 0) > 0 && ::read(STDIN_FILENO, &byte, 1) <= 0;
}

std::uint64_t send_all(Publisher& publisher, const Plan& plan) {
  const auto start = Clock::now();
  std::uint64_t sent = 0;
  while (plan.messages == 0 ? !input_closed() : sent < plan.messages) {
    const std::chrono::duration<double> elapsed = Clock::now() - start;
    const auto due = static_cast<std::uint64_t>(elapsed.count() * plan.rate);
    for (; sent < due && (plan.messages == 0 || sent < plan.messages); ++sent) {
      publisher.publish(location_of(sent % kDevices), now());
      if (sent % kHeartbeatEvery == 0) {
        publisher.publish(v1::Heartbeat(), now());
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const std::chrono::duration<double> elapsed = Clock::now() - start;
  std::printf("%llu %.3f\n",
              static_cast<unsigned long long>(sent),  // NOLINT(google-runtime-int)
              elapsed.count());
  return sent;
}

int run(const Plan& plan) {
  const auto last = std::make_shared<LastMessages>(1000);
  const std::uint64_t epoch = random_epoch();
  auto publisher = Publisher::bind({.endpoint = "tcp://127.0.0.1:*",
                                    .site = "office",
                                    .epoch = epoch,
                                    .linger = std::chrono::seconds(30),
                                    .last = last});
  auto snapshots =
      SnapshotServer::open({.endpoint = "tcp://127.0.0.1:*", .epoch = epoch, .last = last});
  if (!publisher || !snapshots) {
    std::fprintf(stderr, "burst_publisher: no port\n");
    return 1;
  }
  std::printf("%s %s\n", publisher->endpoint().c_str(), (*snapshots)->endpoint().c_str());
  std::fflush(stdout);
  while (publisher->counters().subscriptions < plan.subscriptions) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  send_all(*publisher, plan);
  publisher->publish(v1::Goodbye(), now());
  return 0;
}

}  // namespace
}  // namespace rayloc

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: burst_publisher MESSAGES RATE SUBSCRIPTIONS\n");
    return 64;
  }
  return rayloc::run({std::stoull(argv[1]), std::stod(argv[2]), std::stoull(argv[3])});
}
