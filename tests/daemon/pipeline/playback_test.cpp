// The clock of recordings that people hold and move, at a time that the test states.
#include "daemon/pipeline/playback/playback.h"

#include <gtest/gtest.h>

namespace rayloc::playback_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Running = Playback::Running;

const Timestamp kBegin = Timestamp(seconds(1000));

class PlaybackTest : public ::testing::Test {
 protected:
  // A minute, with a lead of a second.
  void start(std::optional<double> speed) {
    playback_ = std::make_unique<Playback>(Playback::Options{
        {{kBegin, kBegin + seconds(60)}}, speed, seconds(1), seconds(10), [this] { return now_; }});
    EXPECT_EQ(due(kBegin), speed ? seconds(0) : seconds(60));
  }
  // How far after the beginning a source that waits for `next` may deliver.
  Duration due(Timestamp next) {
    return playback_->wait_for(next, playback_->place().number, now_) - kBegin;
  }
  Duration position() const { return playback_->state().position - kBegin; }

  Playback::Clock::time_point now_{};
  std::unique_ptr<Playback> playback_;
};

TEST_F(PlaybackTest, AdvancesBySpeedAndHoldsWhilePaused) {
  start(2.0);
  now_ += seconds(3);
  EXPECT_EQ(position(), seconds(6));
  EXPECT_EQ(due(kBegin + seconds(7)), seconds(6));
  EXPECT_EQ(playback_->change({.play = false}).running, Running::kPaused);
  now_ += seconds(100);
  EXPECT_EQ(position(), seconds(6));
  playback_->change({.play = true, .speed = 0.5});
  now_ += seconds(4);
  EXPECT_EQ(position(), seconds(8));
  EXPECT_EQ(playback_->state().running, Running::kPlaying);
  EXPECT_EQ(playback_->state().moves, 0U);
}

TEST_F(PlaybackTest, ASeekStartsEarlierAndReleasesTheLeadInAtOnce) {
  start(1.0);
  playback_->change({.play = false, .position = kBegin + seconds(30)});
  EXPECT_EQ(playback_->place().number, 1U);
  EXPECT_EQ(playback_->place().from, kBegin + seconds(29));
  EXPECT_EQ(due(kBegin + seconds(29)), seconds(30));
  // A source that is still at the previous place receives nothing more of it.
  EXPECT_EQ(playback_->wait_for(kBegin, 0, now_), Timestamp::min());
  EXPECT_EQ(playback_->state().moves, 1U);
}

TEST_F(PlaybackTest, APositionOutsideIsBroughtInside) {
  start(1.0);
  EXPECT_EQ(playback_->change({.position = kBegin - seconds(5)}).position, kBegin);
  EXPECT_EQ(playback_->change({.position = kBegin + seconds(99)}).running, Running::kEnded);
}

TEST_F(PlaybackTest, EndsAndBeginsAnewWhenPlayed) {
  start(1.0);
  now_ += seconds(59);
  EXPECT_EQ(due(kBegin + seconds(60)), seconds(59));
  now_ += std::chrono::hours(24 * 365 * 50);
  EXPECT_EQ(playback_->state().running, Running::kEnded);
  EXPECT_EQ(position(), seconds(60));
  const Playback::State again = playback_->change({.play = true});
  EXPECT_EQ(again.running, Running::kPlaying);
  EXPECT_EQ(again.position, kBegin);
  EXPECT_EQ(again.moves, 1U);
}

TEST_F(PlaybackTest, WaitsForASourceThatIsLate) {
  start(4.0);
  now_ += seconds(10);
  // A second of lead and half a second of real time; not the 40 s that have passed.
  EXPECT_EQ(due(kBegin + seconds(5)), seconds(8));
  EXPECT_EQ(position(), seconds(8));
  playback_->change({.play = false});
  now_ += seconds(10);
  EXPECT_EQ(due(kBegin + seconds(5)), seconds(8));
}

TEST_F(PlaybackTest, AsFastAsItGoesIsWhereTheSourcesAre) {
  start(std::nullopt);
  playback_->given(kBegin + seconds(10), 0);
  playback_->given(kBegin + seconds(9), 0);
  EXPECT_EQ(position(), seconds(10));
  playback_->change({.play = false});
  EXPECT_EQ(due(kBegin + seconds(11)), seconds(10));
  playback_->change({.play = true, .position = kBegin + seconds(2)});
  playback_->given(kBegin + seconds(50), 0);  // of the place before
  EXPECT_EQ(position(), seconds(2));
  playback_->given(kBegin + seconds(60), 1);
  EXPECT_EQ(playback_->state().running, Running::kEnded);
}

// Four seconds, a clock that was set by a day, four more.
TEST(Field, APlaybackDoesNotWaitForAGap) {
  Playback::Clock::time_point now{};
  const Timestamp later = kBegin + std::chrono::hours(24);
  Playback playback({{{kBegin, kBegin + seconds(4)}, {later, later + seconds(4)}},
                     1.0,
                     seconds(1),
                     seconds(10),
                     [&now] { return now; }});
  EXPECT_EQ(playback.wait_for(kBegin, 0, now), kBegin);
  now += seconds(5);
  EXPECT_EQ(playback.wait_for(later, 0, now), kBegin + seconds(5));
  now += seconds(8);
  EXPECT_EQ(playback.state().position, kBegin + seconds(13));
  now += seconds(1);
  EXPECT_EQ(playback.wait_for(later, 0, now), later);
  now += seconds(2);
  EXPECT_EQ(playback.state().position, later + seconds(2));
  const Playback::State state = playback.state();
  EXPECT_EQ(state.skipped, (std::vector<TimeSpan>{{kBegin + seconds(14), later}}));
  now += seconds(2);
  EXPECT_EQ(playback.state().running, Running::kEnded);
  // A move into the gap and behind it.
  EXPECT_EQ(playback.change({.position = later + seconds(1)}).position, later + seconds(1));
  EXPECT_EQ(playback.change({.play = false, .position = kBegin + std::chrono::hours(5)}).position,
            kBegin + std::chrono::hours(5));
}

TEST(Field, APlayTimeLeavesOutTheLongestGaps) {
  std::vector<TimeSpan> busy;
  Timestamp at = kBegin;
  for (int i = 0; i < 300; ++i) {
    busy.push_back({at, at + seconds(1)});
    at += seconds(20 + i);
  }
  const PlayTime time(busy, seconds(10));
  EXPECT_EQ(time.skipped().size(), PlayTime::kMaxSkipped);
  EXPECT_EQ(time.played(kBegin), seconds(0));
  for (Duration played = seconds(0); played < time.length(); played += milliseconds(7001)) {
    EXPECT_EQ(time.played(time.recorded(played)), played);
  }
  EXPECT_EQ(time.recorded(time.length()), time.end());
}

}  // namespace
}  // namespace rayloc::playback_test
