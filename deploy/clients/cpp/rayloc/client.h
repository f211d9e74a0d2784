// Receives what raylocd publishes.
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
// rayloc/v1/*.pb.h. Connecting again after a restart of raylocd goes by itself; where a snapshot is
// wanted, it is asked for again then.
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

  // From files as `rayloc keygen` makes them: what it printed of the daemon, and the secret key of
  // this subscriber, which only its owner may read. Throws std::runtime_error when one cannot be
  // used.
  static Curve read(const std::string& server_key, const std::string& secret_key);
};

struct Options {
  // Where raylocd publishes.
  std::string endpoint = "tcp://127.0.0.1:5560";
  // Where it tells who comes late what was last said of each topic; empty: begin with what comes.
  std::string snapshot = {};
  // What the topics begin with.
  std::vector<std::string> topics = {"v1/"};
  // Of the messages about a target only those about these: address, hashed address or "person-N".
  // Empty: all.
  std::vector<std::string> targets = {};
  // Time without a heartbeat after which the daemon counts as gone.
  std::chrono::milliseconds stale_after{5000};
  // How long to wait for the daemon and its snapshot, where one is wanted.
  std::chrono::milliseconds patience{10'000};
  // Of a raylocd that publishes encrypted.
  std::optional<Curve> curve = std::nullopt;
};

struct Message {
  std::string topic;
  v1::Envelope envelope;
  bool from_snapshot = false;  // it was said before we came, or before we were back

  // Address, hashed address or "person-N", as in the topic; empty when it is not about a target.
  std::string target() const;
};

class Subscriber {
 public:
  // Without a snapshot it succeeds whether or not somebody publishes. Throws std::invalid_argument
  // for an endpoint or a key that is none, std::runtime_error when a snapshot is wanted and nobody
  // answers.
  explicit Subscriber(Options options);
  ~Subscriber();
  Subscriber(Subscriber&&) noexcept;
  Subscriber& operator=(Subscriber&&) noexcept;

  // The next message; nothing when none came for `timeout` or a signal was caught.
  std::optional<Message> receive(std::chrono::milliseconds timeout);

  // Messages that were published to us and never came.
  std::uint64_t lost() const;
  // New starts of the daemon since we came.
  std::uint64_t restarts() const;
  // What came and was no message of raylocd.
  std::uint64_t malformed() const;
  // No heartbeat for `stale_after`, none yet, or the daemon said goodbye: what you know is no
  // longer, or not yet, how it is. What arrives is looked at in receive().
  bool stale() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc::client
