#include "daemon/pipeline/frame_mailbox.h"

#include <algorithm>
#include <utility>

namespace rayloc {
namespace {

// Stable: frames of one instant stay in the order of the sources.
void sort_by_time(std::vector<CsiFrame>& frames) {
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
}

}  // namespace

FrameMailbox::FrameMailbox(std::size_t sources, std::size_t capacity, Overflow overflow)
    : capacity_(capacity), overflow_(overflow), queues_(sources) {}

Timestamp FrameMailbox::safe_time() const {
  Timestamp earliest = Timestamp::max();
  for (const Queue& queue : queues_) {
    if (!queue.ended && queue.move == move_) {
      earliest = std::min(earliest, queue.safe_time);
    }
  }
  return earliest;
}

void FrameMailbox::insert(Queue& queue, CsiFrame&& frame) {
  // Nearly always the end; a partial frame of an earlier batch may be older than waiting frames.
  auto position = queue.frames.end();
  while (position != queue.frames.begin() && std::prev(position)->time > frame.time) {
    --position;
  }
  queue.frames.insert(position, std::move(frame));
  ++queue.counters.put;
}

// REQUIRES: the mutex is held. Frames of the same instant can only be taken together, regardless of
// their number.
bool FrameMailbox::has_room(const Queue& queue) const {
  return closed_ || queue.frames.size() < capacity_ || queue.frames.front().time >= queue.safe_time;
}

bool FrameMailbox::has_room(std::size_t source) const {
  if (overflow_ == Overflow::kDropOldest) {
    return true;
  }
  const std::lock_guard lock(mutex_);
  return has_room(queues_[source]);
}

void FrameMailbox::put(std::size_t source, std::vector<CsiFrame>& frames, Timestamp safe_time) {
  // A partial frame is released after younger complete ones.
  sort_by_time(frames);
  std::unique_lock lock(mutex_);
  Queue& queue = queues_[source];
  for (CsiFrame& frame : frames) {
    if (queue.frames.size() >= capacity_) {
      if (overflow_ == Overflow::kDropOldest) {
        queue.frames.pop_front();
        ++queue.counters.dropped;
      } else if (!queue.never_waits) {
        // The source that is behind all others never waits here for long: its frames are taken
        // immediately.
        queue.safe_time = std::max(queue.safe_time, std::min(safe_time, frame.time));
        notify_taker();
        taken_.wait(lock, [&] { return has_room(queue); });
      }
    }
    insert(queue, std::move(frame));
  }
  frames.clear();
  if (safe_time > queue.safe_time) {
    queue.safe_time = safe_time;
    notify_taker();
  }
}

void FrameMailbox::move(std::size_t source, std::uint64_t number) {
  std::unique_lock lock(mutex_);
  queues_[source].move = number;
  notify_taker();
  moved_.notify_all();
  moved_.wait(lock, [&] {
    return closed_ || move_ >= number ||
           std::any_of(queues_.begin(), queues_.end(), [&](const Queue& other) {
             return other.move > number;
           });
  });
}

void FrameMailbox::end(std::size_t source) {
  const std::lock_guard lock(mutex_);
  queues_[source].ended = true;
  notify_taker();
}

void FrameMailbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
  taken_.notify_all();
  moved_.notify_all();
  notify_taker();
}

// REQUIRES: the mutex is held.
void FrameMailbox::notify_taker() {
  changed_.notify_one();
  if (wake_ && advanced()) {
    wake_();
  }
}

bool FrameMailbox::all_ended() const {
  return closed_ || std::all_of(queues_.begin(), queues_.end(), [](const Queue& queue) {
           return queue.ended;
         });
}

// True if all sources that have not ended have moved to the same position.
bool FrameMailbox::all_moved() const {
  std::uint64_t to = move_;
  for (const Queue& queue : queues_) {
    to = std::max(to, queue.move);
  }
  return to > move_ && std::all_of(queues_.begin(), queues_.end(), [&](const Queue& queue) {
           return queue.ended || queue.move == to;
         });
}

bool FrameMailbox::advanced() const {
  return safe_time() > last_safe_time_ || all_ended() || all_moved();
}

FrameMailbox::Taken FrameMailbox::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return advanced(); });
  Taken taken = take_locked();
  lock.unlock();
  sort_by_time(taken.frames);
  return taken;
}

std::optional<FrameMailbox::Taken> FrameMailbox::try_take() {
  std::unique_lock lock(mutex_);
  if (!advanced()) {
    return std::nullopt;
  }
  Taken taken = take_locked();
  lock.unlock();
  sort_by_time(taken.frames);
  return taken;
}

// REQUIRES: the mutex is held.
FrameMailbox::Taken FrameMailbox::take_locked() {
  Taken taken;
  taken.ended = all_ended();
  taken.moved = !taken.ended && all_moved();
  const bool all = taken.ended || taken.moved;
  taken.safe_time = all ? Timestamp::max() : safe_time();
  last_safe_time_ = taken.safe_time;
  for (Queue& queue : queues_) {
    while (!queue.frames.empty() && (all || queue.frames.front().time < taken.safe_time)) {
      taken.frames.push_back(std::move(queue.frames.front()));
      queue.frames.pop_front();
      ++queue.counters.taken;
    }
  }
  if (taken.moved) {
    reset_after_seek();
  }
  taken_.notify_all();
  return taken;
}

// REQUIRES: the mutex is held.
void FrameMailbox::reset_after_seek() {
  last_safe_time_ = Timestamp::min();
  for (Queue& queue : queues_) {
    queue.safe_time = Timestamp::min();
    move_ = std::max(move_, queue.move);
  }
  moved_.notify_all();
}

MailboxCounters FrameMailbox::counters(std::size_t source) const {
  const std::lock_guard lock(mutex_);
  MailboxCounters counters = queues_[source].counters;
  counters.waiting = queues_[source].frames.size();
  return counters;
}

}  // namespace rayloc
