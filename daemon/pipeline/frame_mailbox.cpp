#include "daemon/pipeline/frame_mailbox.h"

#include <algorithm>
#include <utility>

namespace rayloc {

FrameMailbox::FrameMailbox(std::size_t sources, std::size_t capacity, Overflow overflow)
    : capacity_(capacity), overflow_(overflow), queues_(sources) {}

Timestamp FrameMailbox::safe_time() const {
  Timestamp earliest = Timestamp::max();
  for (const Queue& queue : queues_) {
    if (!queue.ended) {
      earliest = std::min(earliest, queue.safe_time);
    }
  }
  return earliest;
}

void FrameMailbox::insert(Queue& queue, CsiFrame&& frame) {
  // Nearly always the end; a partial frame of an earlier batch may be older than what waits.
  auto position = queue.frames.end();
  while (position != queue.frames.begin() && std::prev(position)->time > frame.time) {
    --position;
  }
  queue.frames.insert(position, std::move(frame));
  ++queue.counters.put;
}

void FrameMailbox::put(std::size_t source, std::vector<CsiFrame>& frames, Timestamp safe_time) {
  // A partial frame is given out after complete ones that are younger.
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  std::unique_lock lock(mutex_);
  Queue& queue = queues_[source];
  for (CsiFrame& frame : frames) {
    if (queue.frames.size() >= capacity_) {
      if (overflow_ == Overflow::kWait) {
        // The source that is behind all others is never the one that waits here for long: what it
        // has is taken at once.
        queue.safe_time = std::max(queue.safe_time, std::min(safe_time, frame.time));
        changed_.notify_one();
        // Frames of one and the same instant can only be taken together, however many they are.
        taken_.wait(lock, [&] {
          return closed_ || queue.frames.size() < capacity_ ||
                 queue.frames.front().time >= queue.safe_time;
        });
      } else {
        queue.frames.pop_front();
        ++queue.counters.dropped;
      }
    }
    insert(queue, std::move(frame));
  }
  frames.clear();
  if (safe_time > queue.safe_time) {
    queue.safe_time = safe_time;
    changed_.notify_one();
  }
}

void FrameMailbox::end(std::size_t source) {
  const std::lock_guard lock(mutex_);
  queues_[source].ended = true;
  changed_.notify_one();
}

void FrameMailbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
  taken_.notify_all();
}

FrameMailbox::Taken FrameMailbox::take() {
  std::unique_lock lock(mutex_);
  const auto all_ended = [&] {
    return closed_ || std::all_of(queues_.begin(), queues_.end(), [](const Queue& queue) {
             return queue.ended;
           });
  };
  changed_.wait(lock, [&] { return safe_time() > last_safe_time_ || all_ended(); });
  Taken taken;
  taken.ended = all_ended();
  taken.safe_time = taken.ended ? Timestamp::max() : safe_time();
  last_safe_time_ = taken.safe_time;
  for (Queue& queue : queues_) {
    while (!queue.frames.empty() && (taken.ended || queue.frames.front().time < taken.safe_time)) {
      taken.frames.push_back(std::move(queue.frames.front()));
      queue.frames.pop_front();
      ++queue.counters.taken;
    }
  }
  taken_.notify_all();
  lock.unlock();
  std::stable_sort(taken.frames.begin(),
                   taken.frames.end(),
                   [](const CsiFrame& a, const CsiFrame& b) { return a.time < b.time; });
  return taken;
}

MailboxCounters FrameMailbox::counters(std::size_t source) const {
  const std::lock_guard lock(mutex_);
  MailboxCounters counters = queues_[source].counters;
  counters.waiting = queues_[source].frames.size();
  return counters;
}

}  // namespace rayloc
