#include "daemon/pipeline/frame_mailbox.h"

#include <gtest/gtest.h>

#include <thread>

namespace rayloc::frame_mailbox_test {
namespace {

using std::chrono::milliseconds;

Timestamp at(int ms) { return Timestamp(milliseconds(ms)); }

CsiFrame frame_at(int ms, std::size_t access_point = 0) {
  CsiFrame frame;
  frame.time = at(ms);
  frame.access_point = access_point;
  return frame;
}

void put(FrameMailbox& mailbox, std::size_t source, std::vector<int> times, int safe) {
  std::vector<CsiFrame> frames;
  frames.reserve(times.size());
  for (const int ms : times) {
    frames.push_back(frame_at(ms, source));
  }
  mailbox.put(source, frames, at(safe));
}

std::vector<int> times(const FrameMailbox::Taken& taken) {
  std::vector<int> result;
  for (const CsiFrame& frame : taken.frames) {
    result.push_back(static_cast<int>(
        std::chrono::duration_cast<milliseconds>(frame.time.time_since_epoch()).count()));
  }
  return result;
}

TEST(FrameMailbox, MergesSourcesByTime) {
  FrameMailbox mailbox(2, 100, Overflow::kDropOldest);
  put(mailbox, 0, {1, 4, 9}, 10);
  put(mailbox, 1, {2, 3, 5}, 6);
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{1, 2, 3, 4, 5}));
  mailbox.end(1);
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{9}));
  mailbox.end(0);
  EXPECT_TRUE(mailbox.take().ended);
}

TEST(FrameMailbox, HoldsAFrameThatAnEarlierOneMayStillPrecede) {
  FrameMailbox mailbox(1, 100, Overflow::kDropOldest);
  put(mailbox, 0, {20, 10}, 5);  // a partial frame after a younger complete one
  EXPECT_TRUE(mailbox.take().frames.empty());
  put(mailbox, 0, {7}, 15);
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{7, 10}));
  mailbox.end(0);
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{20}));
}

TEST(FrameMailbox, SeparatesFramesBeforeAndAfterASeek) {
  FrameMailbox mailbox(3, 100, Overflow::kWait);
  mailbox.end(2);  // a recording that could not be read
  put(mailbox, 0, {10, 20}, 100);
  std::thread first([&] {
    mailbox.move(0, 1);
    put(mailbox, 0, {1}, 5);
  });
  put(mailbox, 1, {15}, 16);
  std::vector<int> before;
  while (before.size() < 2) {
    const FrameMailbox::Taken taken = mailbox.take();
    EXPECT_FALSE(taken.moved);
    const std::vector<int> some = times(taken);
    before.insert(before.end(), some.begin(), some.end());
  }
  EXPECT_EQ(before, (std::vector<int>{10, 15}));
  put(mailbox, 1, {17}, 18);
  std::thread second([&] {
    mailbox.move(1, 1);
    put(mailbox, 1, {2}, 5);
  });
  FrameMailbox::Taken last = mailbox.take();
  std::vector<int> rest = times(last);
  while (!last.moved) {
    last = mailbox.take();
    for (const int ms : times(last)) {
      rest.push_back(ms);
    }
  }
  EXPECT_EQ(rest, (std::vector<int>{17, 20}));
  first.join();
  second.join();
  const FrameMailbox::Taken after = mailbox.take();
  EXPECT_FALSE(after.moved);
  EXPECT_EQ(times(after), (std::vector<int>{1, 2}));
}

TEST(FrameMailbox, ReleasesLateSourcesOnALaterSeek) {
  FrameMailbox mailbox(2, 100, Overflow::kWait);
  std::thread behind([&] {
    mailbox.move(0, 1);
    mailbox.move(0, 2);
  });
  std::thread ahead([&] { mailbox.move(1, 2); });
  int moves = 0;
  while (moves == 0) {
    moves += mailbox.take().moved ? 1 : 0;
  }
  behind.join();
  ahead.join();
  mailbox.end(0);
  mailbox.end(1);
  EXPECT_TRUE(mailbox.take().ended);
}

TEST(FrameMailbox, DropsTheOldestAndCountsIt) {
  FrameMailbox mailbox(1, 3, Overflow::kDropOldest);
  put(mailbox, 0, {1, 2, 3, 4, 5}, 6);
  const MailboxCounters before = mailbox.counters(0);
  EXPECT_EQ(before.put, 5U);
  EXPECT_EQ(before.dropped, 2U);
  EXPECT_EQ(before.waiting, 3U);
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{3, 4, 5}));
  const MailboxCounters after = mailbox.counters(0);
  EXPECT_EQ(after.put, after.dropped + after.taken + after.waiting);
}

TEST(FrameMailbox, ReplayWaitsAndLosesNothing) {
  constexpr int kFrames = 2000;
  FrameMailbox mailbox(2, 4, Overflow::kWait);
  const auto run = [&](std::size_t source) {
    for (int i = 0; i < kFrames; ++i) {
      put(mailbox, source, {i}, i);
    }
    mailbox.end(source);
  };
  std::thread first(run, 0);
  std::thread second(run, 1);
  std::vector<int> all;
  bool ended = false;
  while (!ended) {
    const auto taken = mailbox.take();
    const std::vector<int> more = times(taken);
    all.insert(all.end(), more.begin(), more.end());
    ended = taken.ended;
  }
  first.join();
  second.join();
  ASSERT_EQ(all.size(), 2U * kFrames);
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
}

TEST(FrameMailbox, HasNoRoomForASourceThatNeverWaits) {
  FrameMailbox mailbox(2, 3, Overflow::kWait);
  mailbox.never_wait(0);
  EXPECT_TRUE(mailbox.has_room(0));
  put(mailbox, 0, {1, 2, 3, 4, 5}, 6);
  EXPECT_EQ(mailbox.counters(0).waiting, 5U);
  EXPECT_FALSE(mailbox.has_room(0));
  put(mailbox, 1, {}, 4);
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{1, 2, 3}));
  EXPECT_TRUE(mailbox.has_room(0));
  put(mailbox, 0, {9, 9, 9}, 9);
  EXPECT_FALSE(mailbox.has_room(0));
  mailbox.end(1);
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{4, 5}));
  EXPECT_TRUE(mailbox.has_room(0)) << "no frame of that instant can be taken before its last one";
  put(mailbox, 0, {9, 10}, 11);
  EXPECT_FALSE(mailbox.has_room(0));
  mailbox.close();
  EXPECT_TRUE(mailbox.has_room(0));
  EXPECT_EQ(mailbox.counters(0).dropped, 0U);
}

// A live source drops its oldest frames on a shared thread as well.
TEST(FrameMailbox, ASourceThatDropsAlwaysHasRoom) {
  FrameMailbox mailbox(1, 3, Overflow::kDropOldest);
  mailbox.never_wait(0);
  put(mailbox, 0, {1, 2, 3, 4, 5}, 6);
  EXPECT_TRUE(mailbox.has_room(0));
  EXPECT_EQ(times(mailbox.take()), (std::vector<int>{3, 4, 5}));
}

TEST(FrameMailbox, ManyFramesOfOneInstantDoNotBlockAReplay) {
  FrameMailbox mailbox(1, 4, Overflow::kWait);
  std::thread source([&] {
    put(mailbox, 0, std::vector<int>(50, 7), 7);
    mailbox.end(0);
  });
  std::size_t taken_frames = 0;
  bool ended = false;
  while (!ended) {
    const auto taken = mailbox.take();
    taken_frames += taken.frames.size();
    ended = taken.ended;
  }
  source.join();
  EXPECT_EQ(taken_frames, 50U);
}

}  // namespace
}  // namespace rayloc::frame_mailbox_test
