// Subscriber: receives what a Publisher sends, for `rayloc sub` and for tests.
//
//   auto subscriber = Subscriber::connect("tcp://127.0.0.1:5560", {"v1/location/"});
//   if (auto message = subscriber->receive(std::chrono::seconds(1))) { ... }
//
// Connecting succeeds whether or not somebody publishes: ZeroMQ connects, and connects again, by
// itself. Thread safety: one thread.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/publish/socket/curve_keys.h"
#include "engine/base/expected.h"

namespace rayloc {

struct PublishedMessage {
  std::string topic;
  std::string payload;         // a serialised v1::Envelope, unless somebody else sent it
  bool from_snapshot = false;  // said before we came (LateSubscriber)
};

class Subscriber {
 public:
  // `prefixes`: what the topics begin with. `high_water_mark`: messages queued here before the
  // publisher's queue fills. `curve`: of a publisher with CURVE. Errors: kUsage for an endpoint
  // that cannot be understood.
  static Expected<Subscriber> connect(const std::string& endpoint,
                                      const std::vector<std::string>& prefixes,
                                      int high_water_mark = 100'000,
                                      const std::optional<CurveClientKeys>& curve = std::nullopt);
  ~Subscriber();
  Subscriber(Subscriber&&) noexcept;
  Subscriber& operator=(Subscriber&&) noexcept;

  // The next message, or nothing when none came for `timeout` or a signal was caught. Messages that
  // are not of two frames are skipped and counted.
  std::optional<PublishedMessage> receive(std::chrono::milliseconds timeout);

  std::uint64_t malformed() const;

 private:
  class Impl;
  explicit Subscriber(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
