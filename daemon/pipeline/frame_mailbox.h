// FrameMailbox: where the receiving threads leave frames and the estimation thread takes them, in
// order of event time over all sources.
//
// Each source has a bounded queue. A live source that finds it full drops the oldest frame and
// counts it; a replay waits instead. A frame is taken once no source can bring an earlier one,
// which each source promises by its safe time: what is taken, and in what order, depends on the
// frames alone and not on when they came.
//
// Thread safety: put() and move() from one thread per source, take() from one thread, counters()
// from any.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
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

  // Moves the frames in. `safe_time`: no later frame of this source will be older.
  void put(std::size_t source, std::vector<CsiFrame>& frames, Timestamp safe_time);

  // The source goes on elsewhere in its recording, for the `number`th time: what it has put is all
  // there is of where it was, and what it puts next may be earlier. Waits until every source has
  // come as far and what they have left is taken. A source that is behind (people move quickly)
  // is let go when another comes with a later number, to which it has to come as well.
  void move(std::size_t source, std::uint64_t number);

  // The source has nothing more to say.
  void end(std::size_t source);

  // Wakes everybody; put() drops from now on and take() gives what is ready, then ends.
  void close();

  struct Taken {
    std::vector<CsiFrame> frames;  // by (time, source)
    Timestamp safe_time;           // nothing older than this will ever be taken
    bool ended = false;            // every source has ended, and this is the last of it
    // The last before the sources go on elsewhere: what comes next has nothing to do with it.
    bool moved = false;
  };
  // Waits until event time advances.
  Taken take();
  // The same without waiting: nothing when event time has not advanced.
  std::optional<Taken> try_take();

  MailboxCounters counters(std::size_t source) const;

 private:
  struct Queue {
    std::deque<CsiFrame> frames;  // by time
    Timestamp safe_time = Timestamp::min();
    bool ended = false;
    std::uint64_t move = 0;  // the last that it has come to
    MailboxCounters counters;
  };

  Timestamp safe_time() const;
  bool all_ended() const;
  bool all_moved() const;
  bool advanced() const;
  Taken take_locked();
  void begin_elsewhere();
  void insert(Queue& queue, CsiFrame&& frame);

  const std::size_t capacity_;
  const Overflow overflow_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;  // event time advanced, or the mailbox closed
  std::condition_variable taken_;    // room was made
  std::condition_variable moved_;    // everybody has come to a move, or somebody to a later one
  std::vector<Queue> queues_;
  Timestamp last_safe_time_ = Timestamp::min();
  std::uint64_t move_ = 0;  // the last that all have come to
  bool closed_ = false;
};

}  // namespace rayloc
