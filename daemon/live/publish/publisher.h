// Publisher: the messages of proto/rayloc/v1 on a ZeroMQ XPUB socket.
//
//   auto publisher = Publisher::bind({.endpoint = "tcp://127.0.0.1:5560", .site = "office",
//                                     .epoch = random_epoch()});
//   publisher->publish(location, now);
//   publisher->publish(goodbye, now);   // the last one; the destructor waits up to `linger`
//
// Each message is two frames, the topic and an Envelope, which the publisher creates: sequence from
// 1 per topic, epoch, `sent` as passed in. It reads no clock.
//
// A subscriber that stops reading loses messages once its queue is full, and detects that by the
// gap in the sequence; it does not affect the others and never blocks the caller. libzmq alone
// offers only two halves of that: XPUB_NODROP lets one stuck subscriber starve all, lossy mode
// hides the loss. So: try with NODROP; on EAGAIN count an episode, send again in lossy mode, switch
// back. Once skipped, a subscriber is left out until it reads again.
//
// Several sites may share the socket: turn_to() sets the site of the following messages. Each has
// its own sequences and classes of topics, and its own bound on topics, so that none displaces
// those of another.
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
  // A listening stream socket to publish on instead (socket activation); the endpoint must then
  // have the socket's kind.
  int adopted_fd = -1;
  std::string site;         // `name` of the first site; part of every topic
  std::uint64_t epoch = 0;  // random_epoch(), or any number that is unique to this start
  // Messages queued per subscriber before it counts as stuck.
  int high_water_mark = 1000;
  // Maximum time for which the destructor waits for subscribers to read the queued messages.
  std::chrono::milliseconds linger{500};
  // Topics of a site whose sequence is stored; beyond it the one longest unused restarts at 1.
  // Keeps memory bounded when devices change their addresses.
  std::size_t max_topics = 4096;
  // Also keeps the last message of each topic, except CSI frames; may be null.
  std::shared_ptr<LastMessages> last = nullptr;
  // The board for viewers of the first site; may be null.
  std::shared_ptr<MessageBoard> board = nullptr;
  // Controls who may subscribe; null: every client that can reach the endpoint.
  std::shared_ptr<ConnectionGuard> guard = nullptr;
};

// Counters as in v1::PublisherCounters.
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
  // Errors: kConfiguration for an invalid endpoint or an empty site name, kUnavailable for one that
  // is in use or cannot be bound.
  static Expected<Publisher> bind(const PublisherOptions& options);
  ~Publisher();
  Publisher(Publisher&&) noexcept;
  Publisher& operator=(Publisher&&) noexcept;

  // The bound endpoint, with the selected port.
  const std::string& endpoint() const;

  // Sets the site of the following messages, and `board` for its viewers (may be null). REQUIRES:
  // `site` is not empty.
  void turn_to(const std::string& site, std::shared_ptr<MessageBoard> board);

  // `sent`: now, by the caller's clock. `coalesced`: earlier updates merged into this one.
  // REQUIRES: the components of the topic (target, zone, access point) are not empty.
  void publish(const v1::Location& location, Timestamp sent, std::uint32_t coalesced = 0);
  // For a method compared with the site's own. REQUIRES: quality.method is not empty, too.
  void publish_compared(const v1::Location& location, Timestamp sent, std::uint32_t coalesced = 0);
  void publish(const v1::TrackEvent& event, Timestamp sent);
  void publish(const v1::ZoneEvent& event, Timestamp sent);
  void publish(const v1::SourceState& state, Timestamp sent);
  void publish(const v1::CsiFrame& frame, Timestamp sent);
  // These two add the publisher's data: epoch, message version, topic classes of the site, and its
  // own counters, which are sums over all sites.
  void publish(v1::Heartbeat heartbeat, Timestamp sent);
  void publish(v1::Goodbye goodbye, Timestamp sent);

  // Subscriptions that began or ended since the last call are counted first.
  PublishedCounters counters();

 private:
  class Impl;
  explicit Publisher(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
