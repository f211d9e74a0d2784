// The clock of recordings that people hold and move, at a time that the test states.
#include "daemon/pipeline/playback.h"

#include <gtest/gtest.h>

namespace rayloc {
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
        kBegin, kBegin + seconds(60), speed, seconds(1), [this] { return now_; }});
    EXPECT_EQ(due(kBegin), speed ? seconds(0) : seconds(60));
  }
  // Until where a source that waits for `next` may give out, after the beginning.
  Duration due(Timestamp next) {
    return playback_->wait_for(next, playback_->place().number, now_) - kBegin;
  }
  Duration position() const { return playback_->state().position - kBegin; }

  Playback::Clock::time_point now_{};
  std::unique_ptr<Playback> playback_;
};

TEST_F(PlaybackTest, GoesOnBySpeedAndStandsStillWhilePaused) {
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

TEST_F(PlaybackTest, AMoveBeginsEarlierAndGivesWhatLeadsThereAtOnce) {
  start(1.0);
  playback_->change({.play = false, .position = kBegin + seconds(30)});
  EXPECT_EQ(playback_->place().number, 1U);
  EXPECT_EQ(playback_->place().from, kBegin + seconds(29));
  EXPECT_EQ(due(kBegin + seconds(29)), seconds(30));
  // Who is still at the place before gets nothing more of it.
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

}  // namespace
}  // namespace rayloc
