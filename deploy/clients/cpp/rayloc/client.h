// Receives the messages that raylocd publishes.
//
//   rayloc::client::Subscriber messages({.topics = {"v1/location/"}});
//   while (true) {
//     const auto message = messages.receive(std::chrono::seconds(1));
//     if (message && message->envelope.location().has_position()) {
//       const auto& position = message->envelope.location().position();
//       std::cout << message->target() << " " << position.x() << std::endl;
//     }
//   }
//
// In CMake: find_package(rayloc REQUIRED), target rayloc::client. The messages are the classes of
// rayloc/v1/*.pb.h. The connection is restored automatically after a restart of raylocd; if a
// snapshot is wanted, it is then requested again.
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayloc/v1/envelope.pb.h"

namespace rayloc::client {

// Keys of an encrypted connection, 40 characters of Z85 each: the daemon's public key, and this
// subscriber's secret one, whose public half the daemon must list under [curve] allow.
struct Curve {
  std::string server_key;
  std::string secret_key;

  // Reads files of `rayloc keygen`: the printed public key of the daemon, and the secret key of
  // this subscriber, which only its owner may read. Throws std::runtime_error when one cannot be
  // used.
  static Curve read(const std::string& server_key, const std::string& secret_key);
};

struct Options {
  // The endpoint at which raylocd publishes.
  std::string endpoint = "tcp://127.0.0.1:5560";
  // The endpoint for the last message of each topic; empty: only messages from now on.
  std::string snapshot = {};
  // Prefixes of the topics.
  std::vector<std::string> topics = {"v1/"};
  // Restricts messages about a target to these: address, hashed address or "person-N".
  // Empty: all targets.
  std::vector<std::string> targets = {};
  // Time without a heartbeat after which the daemon counts as gone.
  std::chrono::milliseconds stale_after{5000};
  // Maximum wait for the daemon, and for its snapshot if one is wanted.
  std::chrono::milliseconds patience{10'000};
  // Keys for a raylocd that publishes encrypted messages.
  std::optional<Curve> curve = std::nullopt;
};

struct Message {
  std::string topic;
  v1::Envelope envelope;
  bool from_snapshot = false;  // published before this subscriber connected or reconnected

  // Address, hashed address or "person-N", as in the topic; empty if it is not about a target.
  std::string target() const;
};

class Subscriber {
 public:
  // Without a snapshot it succeeds even if no daemon publishes. Throws std::invalid_argument
  // for an invalid endpoint or key, std::runtime_error when a snapshot is wanted and there is no
  // answer.
  explicit Subscriber(Options options);
  ~Subscriber();
  Subscriber(Subscriber&&) noexcept;
  Subscriber& operator=(Subscriber&&) noexcept;

  // The next message; empty if none arrived within `timeout` or a signal was caught.
  std::optional<Message> receive(std::chrono::milliseconds timeout);

  // Messages that were published to this subscriber and never arrived.
  std::uint64_t lost() const;
  // Restarts of the daemon since this subscriber connected.
  std::uint64_t restarts() const;
  // Received messages that are not messages of raylocd.
  std::uint64_t malformed() const;
  // True if no heartbeat arrived for `stale_after`, none has arrived yet, or the daemon sent its
  // goodbye: received data may be out of date. Arriving messages are processed in receive().
  bool stale() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc::client
