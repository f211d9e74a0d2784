// Recordings that are moved while they are played, through the whole pipeline: nothing is lost or
// counted twice, and nothing before a move is mixed with what comes after it.
#include "daemon/pipeline/playback/playback_source.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "capture/source/recorded_source.h"
#include "daemon/messages/proto_time.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/pipeline.h"
#include "tests/support/eventually.h"
#include "tests/support/test_paths.h"

namespace rayloc::playback_source_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kPatience{60};

std::string file_of(std::size_t index) {
  return test::data_path("/sites/meeting_room/device_los-ap") + std::to_string(index + 1) +
         ".pcap.gz";
}

Expected<std::unique_ptr<DatagramSource>> open_recording(const std::string& file) {
  auto opened = RecordedSource::open({file});
  RAYLOC_TRY(opened);
  return std::unique_ptr<DatagramSource>(std::move(*opened));
}

// Records the beginnings of bursts, separated at each restart.
class NotingEstimator : public Estimator {
 public:
  void estimate(const Burst& burst, Estimates& /*out*/) override {
    const std::lock_guard lock(mutex_);
    EXPECT_TRUE(std::is_sorted(
        burst.frames.begin(), burst.frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
          return a.time < b.time;
        }));
    parts_.back().push_back(burst.first);
  }
  void restart(const std::string& reason, Estimates& /*out*/) override {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(reason, "the recording was moved to another place");
    parts_.emplace_back();
  }
  // The beginnings of bursts at each place, one place after the other.
  std::vector<std::vector<Timestamp>> parts() const {
    const std::lock_guard lock(mutex_);
    return parts_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::vector<Timestamp>> parts_{1};
};

class IgnoringSink : public LocationSink {
 public:
  void location(Location&& /*location*/) override {}
};

class PlayedRecordings : public ::testing::Test {
 protected:
  void SetUp() override {
    Playback::Options options;
    options.speed = std::nullopt;
    std::vector<RecordingPlan> plans;
    for (std::size_t index = 0; index < 3; ++index) {
      plans.push_back(plan_recording({file_of(index)}).value());
    }
    options.busy = busy_times(plans);
    playback_ = std::make_shared<Playback>(options);
    std::vector<SourceWorker::Input> inputs(3);
    for (std::size_t index = 0; index < 3; ++index) {
      SourceWorker::Input& input = inputs[index];
      input.access_point = "ap" + std::to_string(index + 1);
      input.receiver.access_point = index;
      input.source =
          PlaybackSource::open([index] { return open_recording(file_of(index)); }, playback_)
              .value();
    }
    PipelineOptions pipeline;
    pipeline.overflow = Overflow::kWait;
    pipeline.ring_frames = 16;
    pipeline_ = std::make_unique<Pipeline>(pipeline, std::move(inputs), estimator_, sink_);
  }

  // All that there is has been read and explained.
  bool at_the_end() const {
    std::uint64_t frames = 0;
    for (const SourceReport& report : pipeline_->source_reports()) {
      frames += report.receiver.frames;
      if (!report.ended) {
        return false;
      }
    }
    const EstimationCounters counters = pipeline_->estimation_counters();
    return playback_->state().running == Playback::Running::kEnded && counters.taken == frames &&
           counters.in_flight == 0;
  }
  bool played(std::size_t parts) const {
    return eventually(kPatience, [&] {
      return at_the_end() && estimator_.parts().size() == parts &&
             !estimator_.parts().back().empty();
    });
  }
  void expect_conservation() const {
    const auto reports = pipeline_->source_reports();
    const auto mailbox = pipeline_->mailbox_counters();
    std::uint64_t taken = 0;
    for (std::size_t i = 0; i < reports.size(); ++i) {
      EXPECT_EQ(reports[i].error, "");
      EXPECT_EQ(reports[i].source.received, reports[i].source.delivered);
      EXPECT_EQ(reports[i].receiver.received, reports[i].source.delivered);
      EXPECT_EQ(reports[i].receiver.received,
                reports[i].receiver.in_frames + reports[i].receiver.duplicates +
                    reports[i].receiver.late);
      EXPECT_EQ(mailbox[i].put, reports[i].receiver.frames);
      EXPECT_EQ(mailbox[i].put, mailbox[i].taken);
      taken += mailbox[i].taken;
    }
    const EstimationCounters counters = pipeline_->estimation_counters();
    EXPECT_EQ(counters.taken, taken);
    EXPECT_EQ(counters.taken,
              counters.unwanted + counters.used + counters.surplus + counters.in_flight);
    EXPECT_EQ(counters.in_flight, 0U);
  }

  NotingEstimator estimator_;
  IgnoringSink sink_;
  std::shared_ptr<Playback> playback_;
  std::unique_ptr<Pipeline> pipeline_;
};

TEST_F(PlayedRecordings, GoBackFromTheEndAndGiveTheSameAgain) {
  pipeline_->start();
  ASSERT_TRUE(played(1));
  playback_->change({.play = true});
  ASSERT_TRUE(played(2));
  const auto parts = estimator_.parts();
  EXPECT_GT(parts[0].size(), 20U);
  EXPECT_EQ(parts[1], parts[0]);
  expect_conservation();
}

TEST_F(PlayedRecordings, BeginALeadBeforeWhereTheyAreMovedTo) {
  pipeline_->start();
  ASSERT_TRUE(played(1));
  const auto whole = estimator_.parts()[0];
  const Timestamp to = whole[whole.size() / 2];
  playback_->change({.position = to});
  ASSERT_TRUE(played(2));
  const auto parts = estimator_.parts();
  EXPECT_LT(parts[1].front(), to);
  EXPECT_GE(parts[1].front(), to - milliseconds(700));
  EXPECT_EQ(parts[1].back(), whole.back());
  expect_conservation();
}

TEST_F(PlayedRecordings, ManyQuickMovesLeaveEverythingCounted) {
  playback_->change({.speed = 20.0});
  pipeline_->start();
  const Playback::State whole = playback_->state();
  for (int i = 0; i < 50; ++i) {
    playback_->change(
        {.play = i % 3 != 0, .position = whole.begin + (whole.end - whole.begin) / 50 * i});
  }
  playback_->change({.play = true, .speed = std::optional<double>(), .position = whole.begin});
  ASSERT_TRUE(
      eventually(kPatience, [&] { return at_the_end() && estimator_.parts().back().size() > 20; }));
  EXPECT_EQ(playback_->state().moves, 51U);
  // A place that was left before all sources had come to it is none.
  EXPECT_LE(estimator_.parts().size(), 52U);
  for (const auto& part : estimator_.parts()) {
    EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
  }
  expect_conservation();
}

TEST_F(PlayedRecordings, StopWhileTheyArePaused) {
  playback_->change({.play = false, .position = playback_->state().begin + seconds(1)});
  pipeline_->start();
  pipeline_->stop();
  EXPECT_TRUE(pipeline_->finished());
}

}  // namespace
}  // namespace rayloc::playback_source_test
