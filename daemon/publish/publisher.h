// Publisher: the messages of proto/rayloc/v1 on a ZeroMQ XPUB socket.
//
//   auto publisher = Publisher::bind({.endpoint = "tcp://127.0.0.1:5560", .site = "office",
//                                     .epoch = random_epoch()});
//   publisher->publish(location, now);
//   publisher->publish(goodbye, now);   // the last one; the destructor waits up to `linger`
//
// Each message is two frames, the topic and an Envelope, which the publisher makes: sequence from 1
// per topic, epoch, `sent` as passed in. It reads no clock.
//
// A subscriber that stops reading loses messages once its queue is full, and sees that by the gap
// in the sequence; it costs the others nothing and never blocks the caller. libzmq alone offers
// only the two halves of that: XPUB_NODROP lets one stuck subscriber starve
// all, lossy mode hides the loss. So: try with NODROP; on EAGAIN count an episode, send again in
// lossy mode, switch back. Once skipped, a subscriber is left out until it reads again.
//
// Several sites may share the socket: turn_to() says whose messages follow. Each has sequences and
// classes of topics of its own, and its own bound on topics, so that none displaces those of
// another.
//
// Thread safety: one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::v1 {
class CsiFrame;
class Goodbye;
class Heartbeat;
class Location;
class SourceState;
class TrackEvent;
class ZoneEvent;
}  // namespace rayloc::v1

namespace rayloc {

class ConnectionGuard;
class LastMessages;
class MessageBoard;

struct PublisherOptions {
  // tcp://ADDRESS:PORT ("*" as the port: any free one), or ipc://PATH.
  std::string endpoint = "tcp://127.0.0.1:5560";
  // A listening stream socket to publish on instead (socket activation); the endpoint must then be
  // of the socket's kind.
  int adopted_fd = -1;
  std::string site;         // `name` of the first site; part of every topic
  std::uint64_t epoch = 0;  // random_epoch(), or any number that no other start has
  // Messages queued per subscriber before it counts as stuck.
  int high_water_mark = 1000;
  // How long the destructor waits for subscribers to fetch what is queued.
  std::chrono::milliseconds linger{500};
  // Topics of a site whose sequence is remembered; past that the one longest unused begins at 1
  // again. Keeps memory bounded when devices change their addresses.
  std::size_t max_topics = 4096;
  // Where the last message of each topic is kept as well, frames of CSI aside; may be null.
  std::shared_ptr<LastMessages> last = nullptr;
  // Where viewers of the first site look; may be null.
  std::shared_ptr<MessageBoard> board = nullptr;
  // Who may subscribe; null: everyone who can reach the endpoint.
  std::shared_ptr<ConnectionGuard> guard = nullptr;
};

// As in v1::PublisherCounters.
struct PublishedCounters {
  std::uint64_t published = 0;
  std::uint64_t slow_episodes = 0;
  std::uint64_t subscriptions = 0;
  std::uint64_t clients_denied = 0;
  std::uint64_t handshakes_failed = 0;
  std::uint64_t clients_cut_off = 0;
};

// 64 bits from the system's entropy; never 0.
std::uint64_t random_epoch();

class Publisher {
 public:
  // Errors: kConfiguration for an endpoint that cannot be understood or an empty site name,
  // kUnavailable for one that is in use or cannot be bound.
  static Expected<Publisher> bind(const PublisherOptions& options);
  ~Publisher();
  Publisher(Publisher&&) noexcept;
  Publisher& operator=(Publisher&&) noexcept;

  // Where it is bound, with the port that was chosen.
  const std::string& endpoint() const;

  // The messages that follow are of this site, and `board` is where its viewers look (may be null).
  // REQUIRES: `site` is not empty.
  void turn_to(const std::string& site, std::shared_ptr<MessageBoard> board);

  // `sent`: now, by the caller's clock. `coalesced`: updates merged into this one before.
  // REQUIRES: what the topic is made of (target, zone, access point) is not empty.
  void publish(const v1::Location& location, Timestamp sent, std::uint32_t coalesced = 0);
  // Of a method that is compared with the site's own. REQUIRES: quality.method is not empty, too.
  void publish_compared(const v1::Location& location, Timestamp sent, std::uint32_t coalesced = 0);
  void publish(const v1::TrackEvent& event, Timestamp sent);
  void publish(const v1::ZoneEvent& event, Timestamp sent);
  void publish(const v1::SourceState& state, Timestamp sent);
  void publish(const v1::CsiFrame& frame, Timestamp sent);
  // These two add what the publisher knows: epoch, message version, topic classes of the site, and
  // its own counters, which are of all sites together.
  void publish(v1::Heartbeat heartbeat, Timestamp sent);
  void publish(v1::Goodbye goodbye, Timestamp sent);

  // Subscriptions that came or went since the last call are counted first.
  PublishedCounters counters();

 private:
  class Impl;
  explicit Publisher(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
