// Subscriber: receives the messages of a Publisher, for `rayloc sub` and for tests.
//
//   auto subscriber = Subscriber::connect("tcp://127.0.0.1:5560", {"v1/location/"});
//   if (auto message = subscriber->receive(std::chrono::seconds(1))) { ... }
//
// Connecting succeeds with or without a publisher: ZeroMQ connects and reconnects automatically.
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/live/publish/socket/curve_keys.h"
#include "engine/base/expected.h"

namespace rayloc {

struct PublishedMessage {
  std::string topic;
  std::string payload;         // a serialised v1::Envelope, unless from a foreign sender
  bool from_snapshot = false;  // published before the subscription (LateSubscriber)
};

class Subscriber {
 public:
  // `prefixes`: of the topics. `high_water_mark`: messages queued here before the
  // publisher's queue fills. `curve`: for a publisher with CURVE. Errors: kUsage for an
  // invalid endpoint.
  static Expected<Subscriber> connect(const std::string& endpoint,
                                      const std::vector<std::string>& prefixes,
                                      int high_water_mark = 100'000,
                                      const std::optional<CurveClientKeys>& curve = std::nullopt);
  ~Subscriber();
  Subscriber(Subscriber&&) noexcept;
  Subscriber& operator=(Subscriber&&) noexcept;

  // Returns the next message, or empty if none arrived within `timeout` or a signal was caught.
  // Messages without exactly two frames are skipped and counted.
  std::optional<PublishedMessage> receive(std::chrono::milliseconds timeout);

  std::uint64_t malformed() const;

 private:
  class Impl;
  explicit Subscriber(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
