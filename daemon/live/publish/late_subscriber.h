// LateSubscriber: a subscriber that receives the last message of each topic first and then every
// later message, each sequence once. After a restart of the daemon it begins again in the same
// manner.
//
// It subscribes, to heartbeats last, and requests the snapshot when a heartbeat arrives: the
// publisher then has all of its subscriptions, so that no message is lost between the two. It
// repeats the request with each heartbeat until an answer arrives, since a request may reach a
// daemon that is ending; messages are queued meanwhile. Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/live/publish/subscriber.h"
#include "engine/base/expected.h"

namespace rayloc {

class LateSubscriber {
 public:
  // `endpoint`: of the Publisher, `snapshot`: of the SnapshotServer. Waits up to `patience` for a
  // heartbeat and the snapshot; it waits as long for the snapshot after a restart, and proceeds
  // without it. kUsage for invalid endpoints, kUnavailable if there is no answer. `curve`: for a
  // publisher with CURVE.
  static Expected<LateSubscriber> join(const std::string& endpoint,
                                       const std::string& snapshot,
                                       const std::vector<std::string>& prefixes,
                                       std::chrono::milliseconds patience,
                                       const std::optional<CurveClientKeys>& curve = std::nullopt);
  ~LateSubscriber();
  LateSubscriber(LateSubscriber&&) noexcept;
  LateSubscriber& operator=(LateSubscriber&&) noexcept;

  // Returns the snapshot's messages, then those published since. Empty if none arrived within
  // `timeout` or a signal was caught.
  std::optional<PublishedMessage> receive(std::chrono::milliseconds timeout);

  std::uint64_t malformed() const { return subscriber_.malformed(); }
  // Number of topics whose sequence in the snapshot is still stored: none after a heartbeat that
  // was sent after the snapshot.
  std::size_t remembered() const { return in_snapshot_.size(); }

 private:
  using Clock = std::chrono::steady_clock;
  class Question;

  LateSubscriber(Subscriber subscriber,
                 std::unique_ptr<Question> question,
                 std::vector<std::string> prefixes,
                 std::chrono::milliseconds patience);
  Expected<void> wait_for_snapshot(const std::string& endpoint, const std::string& snapshot);
  bool step(Clock::time_point deadline);
  void take(PublishedMessage message);
  void begin_anew();
  void take_snapshot(const std::string& reply);
  void go_live();
  void accept(PublishedMessage message, std::uint64_t sequence);
  bool wanted(const std::string& topic) const;

  struct Early {
    PublishedMessage message;
    std::uint64_t sequence = 0;
  };

  Subscriber subscriber_;
  std::unique_ptr<Question> question_;
  std::vector<std::string> prefixes_;
  std::chrono::milliseconds patience_;
  std::optional<std::uint64_t> epoch_;                // epoch received last
  bool joining_ = true;                               // the snapshot has not arrived yet
  std::optional<Clock::time_point> asked_;            // time of the first request for it
  std::map<std::string, std::uint64_t> in_snapshot_;  // sequence of each topic of the snapshot
  std::deque<Early> early_;                           // messages received before the snapshot
  std::deque<PublishedMessage> ready_;
};

}  // namespace rayloc
