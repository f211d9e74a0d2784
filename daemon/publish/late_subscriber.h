// LateSubscriber: a subscriber that begins with what was last said of each topic and goes on with
// every message since, each sequence once. When the daemon was started again it begins anew in the
// same way.
//
// It subscribes, to heartbeats last, and asks for the snapshot when a heartbeat is here: the
// publisher then knows all of its subscriptions, so that nothing falls between the two. It asks
// with each heartbeat until an answer comes, since a question may go to a daemon that is just
// ending; messages wait meanwhile. Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/publish/subscriber.h"
#include "engine/base/expected.h"

namespace rayloc {

class LateSubscriber {
 public:
  // `endpoint`: of the Publisher, `snapshot`: of the SnapshotServer. Waits up to `patience` for a
  // heartbeat and the snapshot; so long it also waits for the snapshot after a restart, and goes on
  // without. kUsage for endpoints that are none, kUnavailable when nobody answers. `curve`: of a
  // publisher with CURVE.
  static Expected<LateSubscriber> join(const std::string& endpoint,
                                       const std::string& snapshot,
                                       const std::vector<std::string>& prefixes,
                                       std::chrono::milliseconds patience,
                                       const std::optional<CurveClientKeys>& curve = std::nullopt);
  ~LateSubscriber();
  LateSubscriber(LateSubscriber&&) noexcept;
  LateSubscriber& operator=(LateSubscriber&&) noexcept;

  // The snapshot's messages, then those that were published since. Nothing when none came for
  // `timeout` or a signal was caught.
  std::optional<PublishedMessage> receive(std::chrono::milliseconds timeout);

  std::uint64_t malformed() const { return subscriber_.malformed(); }
  // Topics of which it still has to know what the snapshot told: none once a heartbeat has come
  // that was sent after it.
  std::size_t remembered() const { return told_.size(); }

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
  std::optional<std::uint64_t> epoch_;         // heard last
  bool joining_ = true;                        // the snapshot is still to come
  std::optional<Clock::time_point> asked_;     // first, for that
  std::map<std::string, std::uint64_t> told_;  // sequence of each topic of the snapshot
  std::deque<Early> early_;                    // came before the snapshot
  std::deque<PublishedMessage> ready_;
};

}  // namespace rayloc
