// MessageBoard: the latest message on each subject, for viewers that poll for changes. A viewer is
// represented by a number, so that a slow one needs no memory.
//
// A subject is a topic, split if one topic carries several kinds of state: a target has one subject
// for its snapshots and one for its filtered estimates, and the last events of a topic are kept one
// by one. CSI frames are excluded.
//
// The places of targets in the last hours are summed here as well (board/presence.h).
//
// Memory is bounded: beyond `max_subjects` the subject written longest ago is removed. Thread
// safety: all members from any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/live/publish/board/presence.h"
#include "engine/base/timestamp.h"

namespace rayloc::v1 {
class Envelope;
}  // namespace rayloc::v1

namespace rayloc {

class MessageBoard {
 public:
  // `presence_kept`: positive; retention time of the places of targets.
  explicit MessageBoard(std::size_t max_subjects, Duration presence_kept = std::chrono::hours(24))
      : max_subjects_(max_subjects), presence_(presence_kept) {}

  // `bytes`: `envelope`, serialised.
  void put(const std::string& topic, const v1::Envelope& envelope, std::string bytes);

  struct Message {
    std::uint64_t revision = 0;  // number of messages put up to and including this one
    std::shared_ptr<const std::string> envelope;
  };
  // Returns the messages put after that revision that are still the latest on their subject, oldest
  // first, `limit` at most.
  std::vector<Message> after(std::uint64_t revision, std::size_t limit) const;

  std::uint64_t revision() const;

  struct PresenceNow {
    std::vector<Presence::Cell> cells;
    Duration kept{};
    std::uint64_t left_out = 0;
  };
  PresenceNow presence(Timestamp now) const;

 private:
  struct Entry {
    std::string subject;
    std::shared_ptr<const std::string> envelope;
  };
  const std::size_t max_subjects_;
  mutable std::mutex mutex_;
  std::uint64_t revision_ = 0;                       // guarded by mutex_
  std::map<std::uint64_t, Entry> entries_;           // by revision; guarded by mutex_
  std::map<std::string, std::uint64_t> of_subject_;  // guarded by mutex_
  Presence presence_;                                // guarded by mutex_
};

}  // namespace rayloc
