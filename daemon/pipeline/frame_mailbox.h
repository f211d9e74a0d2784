// FrameMailbox: passes frames from the receiving threads to the estimation thread, in order of
// event time over all sources.
//
// Each source has a bounded queue. A live source that finds it full drops the oldest frame and
// counts it; a replay waits instead. A frame is taken once no source can deliver an earlier one,
// which each source promises by its safe time: the taken frames and their order depend on the
// frames alone and not on their arrival times.
//
// Thread safety: put() and move() from one thread per source, take() from one thread, counters()
// from any.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc {

enum class Overflow { kDropOldest, kWait };

// put = dropped + taken + waiting, per source.
struct MailboxCounters {
  std::uint64_t put = 0;
  std::uint64_t dropped = 0;
  std::uint64_t taken = 0;
  std::uint64_t waiting = 0;
};

class FrameMailbox {
 public:
  FrameMailbox(std::size_t sources, std::size_t capacity, Overflow overflow);

  // For a source whose thread serves others as well: its put() waits for no room, and may exceed
  // the capacity. The source asks has_room() before it reads more. To be called before the first
  // put().
  void never_wait(std::size_t source) { queues_[source].never_waits = true; }
  // False while a put() that waits for room would wait.
  bool has_room(std::size_t source) const;

  // Moves the frames in. `safe_time`: no later frame of this source will be older.
  void put(std::size_t source, std::vector<CsiFrame>& frames, Timestamp safe_time);

  // The source continues at another position of its recording, by seek `number`. All frames of the
  // old position are put, and later ones may be earlier in time. Waits until every source is there
  // and the remaining frames are taken. A source that is behind (seeks in quick succession) is
  // released when another comes with a later number, which it has to follow as well.
  void move(std::size_t source, std::uint64_t number);

  // The source delivers no more frames.
  void end(std::size_t source);

  // For a taker that does not wait: `wake` is called, by the threads of the sources, when event
  // time has advanced, and when the mailbox is closed. It must not call the mailbox. To be called
  // before the first put().
  void on_advance(std::function<void()> wake) { wake_ = std::move(wake); }

  // Wakes all threads; from now on put() drops and take() returns the ready frames, then ends.
  void close();

  struct Taken {
    std::vector<CsiFrame> frames;  // by (time, source)
    Timestamp safe_time;           // no older frame will ever be taken
    bool ended = false;            // every source has ended, and these are the last frames
    // The last frames before the sources change position: later frames are unrelated to them.
    bool moved = false;
  };
  // Waits until event time advances.
  Taken take();
  // The same without waiting: empty when event time has not advanced.
  std::optional<Taken> try_take();

  MailboxCounters counters(std::size_t source) const;

 private:
  struct Queue {
    std::deque<CsiFrame> frames;  // by time
    Timestamp safe_time = Timestamp::min();
    bool ended = false;
    bool never_waits = false;
    std::uint64_t move = 0;  // number of its last seek
    MailboxCounters counters;
  };

  Timestamp safe_time() const;
  bool has_room(const Queue& queue) const;
  bool all_ended() const;
  bool all_moved() const;
  bool advanced() const;
  Taken take_locked();
  void reset_after_seek();
  void insert(Queue& queue, CsiFrame&& frame);
  void notify_taker();

  const std::size_t capacity_;
  const Overflow overflow_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;  // event time advanced, or the mailbox closed
  std::condition_variable taken_;    // room was made
  std::condition_variable moved_;    // all sources have arrived at a seek, or one at a later seek
  std::vector<Queue> queues_;
  Timestamp last_safe_time_ = Timestamp::min();
  std::uint64_t move_ = 0;  // last seek that all sources have completed
  bool closed_ = false;
  std::function<void()> wake_;
};

}  // namespace rayloc
