// Tests the path from datagrams to locations, with an estimator that only describes its bursts:
// speed, threads and queues must neither lose nor change anything.
#include "daemon/pipeline/pipeline.h"

#include <gtest/gtest.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <future>
#include <numeric>
#include <thread>

#include "capture/source/pcap_source.h"
#include "capture/transport/file_descriptor.h"
#include "daemon/messages/location_message.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/playback/paced_source.h"
#include "daemon/pipeline/shared/shared_threads.h"
#include "tests/support/test_paths.h"

namespace rayloc::pipeline_test {
namespace {

const std::string kSite = test::data_path("/sites/meeting_room/");

// Lists the frames of each burst: any change of order or content changes the text.
class DescribingEstimator : public Estimator {
 public:
  void estimate(const Burst& burst, Estimates& out) override {
    Location location;
    location.target.address = to_string(burst.transmitter);
    location.estimate.time = burst.first + (burst.last - burst.first) / 2;
    std::string text;
    for (const CsiFrame& frame : burst.frames) {
      double sum = 0.0;
      for (const std::complex<float>& value : frame.csi.values()) {
        sum += static_cast<double>(std::norm(value));
      }
      text += std::to_string(frame.access_point) + ":" + std::to_string(frame.sequence) + ":" +
              std::to_string(frame.rx_chains.size()) + ":" + std::to_string(sum) + " ";
    }
    location.estimate.reason = text;
    out.locations.push_back(std::move(location));
  }
};

// A recording that has a descriptor, so that a shared thread reads it like the stream of a cluster.
class PolledRecording : public DatagramSource {
 public:
  explicit PolledRecording(std::unique_ptr<DatagramSource> recording)
      : recording_(std::move(recording)) {}
  Expected<void> read(DatagramBatch& batch, Duration timeout) override {
    return recording_->read(batch, timeout);
  }
  SourceCounters counters() const override { return recording_->counters(); }
  std::string description() const override { return recording_->description(); }
  std::optional<int> poll_descriptor() const override { return readable_.get(); }

 private:
  const std::unique_ptr<DatagramSource> recording_;
  const FileDescriptor readable_{::eventfd(1, EFD_CLOEXEC | EFD_NONBLOCK)};
};

struct Outcome {
  std::size_t sharing_stages = 0;
  std::string locations;
  EstimationCounters counters;
  std::vector<SourceReport> sources;
  std::vector<MailboxCounters> mailbox;
};

Outcome replay(std::size_t ring_frames,
               std::shared_ptr<Pace> pace,
               std::size_t sources = 3,
               std::shared_ptr<SharedThreads> threads = nullptr,
               bool polled = false) {
  std::vector<SourceWorker::Input> inputs;
  for (std::size_t index = 0; index < sources; ++index) {
    const std::string id = "ap" + std::to_string(index + 1);
    std::string recording = kSite;
    recording.append("device_los-").append(id).append(".pcap.gz");
    SourceWorker::Input input;
    input.access_point = id;
    input.source = PcapFileSource::open(recording).value();
    if (pace) {
      input.source = std::make_unique<PacedSource>(std::move(input.source), pace);
    }
    if (polled) {
      input.source = std::make_unique<PolledRecording>(std::move(input.source));
    }
    input.receiver.access_point = index;
    inputs.push_back(std::move(input));
  }
  Outcome outcome;
  DescribingEstimator estimator;
  OrderedSink sink([&](const Location& location) {
    outcome.locations += location_message(location).SerializeAsString() + "\n";
  });
  PipelineOptions options;
  options.ring_frames = ring_frames;
  options.overflow = Overflow::kWait;
  options.threads = std::move(threads);
  Pipeline pipeline(options, std::move(inputs), estimator, sink);
  pipeline.start();
  pipeline.wait();
  sink.finish();
  EXPECT_TRUE(pipeline.finished());
  outcome.counters = pipeline.estimation_counters();
  outcome.sources = pipeline.source_reports();
  outcome.mailbox = pipeline.mailbox_counters();
  const std::vector<Stage> stages = pipeline.stages();
  outcome.sharing_stages = static_cast<std::size_t>(std::count_if(
      stages.begin(), stages.end(), [](const Stage& stage) { return stage.has_shared_thread; }));
  return outcome;
}

TEST(Pipeline, LosesNothingThatItDoesNotCount) {
  const Outcome outcome = replay(8192, nullptr);
  std::uint64_t taken = 0;
  for (std::size_t i = 0; i < outcome.sources.size(); ++i) {
    const SourceReport& report = outcome.sources[i];
    EXPECT_EQ(report.error, "");
    EXPECT_TRUE(report.ended);
    EXPECT_GT(report.source.received, 100U);
    EXPECT_EQ(report.source.received, report.source.delivered);
    const CsiReceiverCounters& receiver = report.receiver;
    EXPECT_EQ(receiver.received, report.source.delivered);
    EXPECT_TRUE(receiver.rejected.empty());
    EXPECT_EQ(receiver.received, receiver.in_frames + receiver.duplicates + receiver.late);
    EXPECT_EQ(receiver.in_flight, 0U);
    EXPECT_EQ(outcome.mailbox[i].put, receiver.frames);
    EXPECT_EQ(outcome.mailbox[i].dropped, 0U);
    taken += outcome.mailbox[i].taken;
  }
  EXPECT_EQ(outcome.counters.taken, taken);
  EXPECT_EQ(outcome.counters.used, taken);
  EXPECT_EQ(outcome.counters.in_flight, 0U);
  EXPECT_EQ(outcome.counters.bursts_in_flight, 0U);
  EXPECT_GT(outcome.counters.bursts, 20U);
  EXPECT_TRUE(outcome.counters.ranks.empty()) << "a replay has no priorities";
}

TEST(Pipeline, ReplayDependsNeitherOnSpeedNorOnQueues) {
  const Outcome reference = replay(8192, nullptr);
  EXPECT_EQ(replay(8192, nullptr).locations, reference.locations);
  EXPECT_EQ(replay(3, nullptr).locations, reference.locations);
  EXPECT_EQ(replay(8192, std::make_shared<Pace>(200.0)).locations, reference.locations);
}

TEST(Pipeline, ReplayDoesNotDependOnSharedThreads) {
  const Outcome reference = replay(8192, nullptr);
  for (const std::size_t workers : {1U, 3U}) {
    const auto threads = std::make_shared<SharedThreads>(1, workers);
    EXPECT_EQ(replay(8192, nullptr, 3, threads).locations, reference.locations);
    const Outcome narrow = replay(3, nullptr, 3, threads);
    EXPECT_EQ(narrow.locations, reference.locations);
    EXPECT_EQ(narrow.counters.used, reference.counters.used);
    EXPECT_EQ(narrow.counters.in_flight, 0U);
  }
}

// One thread reads all sources: if one of them waited for room, no other could make it.
TEST(Pipeline, SourcesThatWaitForRoomMayShareOneThread) {
  const Outcome reference = replay(8192, nullptr);
  const auto threads = std::make_shared<SharedThreads>(1, 2);
  for (const std::size_t ring_frames : {3U, 8192U}) {
    const Outcome shared = replay(ring_frames, nullptr, 3, threads, true);
    EXPECT_EQ(shared.sharing_stages, 4U);
    EXPECT_EQ(shared.locations, reference.locations);
    EXPECT_EQ(shared.counters.used, reference.counters.used);
    for (const MailboxCounters& mailbox : shared.mailbox) {
      EXPECT_EQ(mailbox.put, mailbox.taken);
    }
  }
  EXPECT_EQ(threads->receivers.threads(), 1U);
}

// Reports the end of its tracks as an event with the reason.
class EndingEstimator : public DescribingEstimator {
 public:
  void restart(const std::string& reason, Estimates& out) override {
    TrackEvent event;
    event.transition.reason = reason;
    out.events.push_back(event);
  }
};

class EventSink : public LocationSink {
 public:
  using LocationSink::event;
  void location(Location&& /*location*/) override { EXPECT_TRUE(reasons.empty()); }
  void event(TrackEvent&& event) override { reasons.push_back(event.transition.reason); }
  std::vector<std::string> reasons;
};

TEST(Pipeline, EndsTracksAndReleasesItsSources) {
  for (const bool ends : {false, true}) {
    EndingEstimator estimator;
    EventSink sink;
    PipelineOptions options;
    options.overflow = Overflow::kWait;
    std::vector<SourceWorker::Input> inputs(1);
    inputs[0].access_point = "ap1";
    inputs[0].source = PcapFileSource::open(kSite + std::string("device_los-ap1.pcap.gz")).value();
    const DatagramSource* const source = inputs[0].source.get();
    Pipeline pipeline(options, std::move(inputs), estimator, sink);
    if (ends) {
      pipeline.end_tracks("it is over");
    }
    pipeline.start();
    pipeline.wait();
    EXPECT_EQ(sink.reasons,
              ends ? std::vector<std::string>{"it is over"} : std::vector<std::string>{});
    const auto released = pipeline.release_sources();
    ASSERT_EQ(released.size(), 1U);
    EXPECT_EQ(released[0].get(), source);
    EXPECT_EQ(pipeline.source_reports().front().access_point, "ap1");
  }
}

// As one that takes longer than the recording lasts: nothing ends before everything has come.
class SlowEstimator : public DescribingEstimator {
 public:
  void estimate(const Burst& burst, Estimates& out) override {
    explained_.push_back(burst);
    if (explained_.size() == 1) {
      released_.wait();
    }
    DescribingEstimator::estimate(burst, out);
  }
  void release() { release_.set_value(); }
  const std::vector<Burst>& explained() const { return explained_; }

 private:
  std::promise<void> release_;
  std::future<void> released_ = release_.get_future();
  std::vector<Burst> explained_;
};

TEST(Pipeline, LiveTakesTheNewestBurstAndCountsMergedBursts) {
  SlowEstimator estimator;
  OrderedSink sink([](const Location&) {});
  std::vector<SourceWorker::Input> inputs(1);
  inputs[0].access_point = "ap1";
  // Half a second for all of it: at once, it might have ended before the estimator has begun.
  inputs[0].source = std::make_unique<PacedSource>(
      PcapFileSource::open(std::string(kSite) + "device_los-ap1.pcap.gz").value(),
      std::make_shared<Pace>(200.0));
  Pipeline pipeline({}, std::move(inputs), estimator, sink);
  pipeline.start();
  // The source never waits for the estimator, which is busy with the first burst.
  while (!pipeline.source_reports()[0].ended) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  estimator.release();
  pipeline.wait();

  const EstimationCounters counters = pipeline.estimation_counters();
  const std::vector<Burst>& explained = estimator.explained();
  ASSERT_GE(explained.size(), 2U);
  EXPECT_LT(explained.size(), 5U);  // of more than twenty
  EXPECT_EQ(counters.bursts, explained.size());
  EXPECT_GT(counters.bursts_merged, 15U);
  EXPECT_EQ(counters.taken,
            counters.used + counters.surplus + counters.unwanted + counters.refused +
                counters.merged + counters.dropped + counters.in_flight);
  EXPECT_EQ(counters.in_flight, 0U);
  ASSERT_EQ(counters.ranks.size(), kRanks);
  const RankCounts& others = counters.ranks.back();  // none is listed or has a track
  EXPECT_EQ(others.taken, counters.bursts);
  EXPECT_EQ(others.merged, counters.bursts_merged);
  EXPECT_EQ(others.dropped, counters.bursts_dropped);
  EXPECT_EQ(others.waiting, 0U);
  EXPECT_EQ(counters.taken + pipeline.mailbox_counters()[0].dropped,
            pipeline.source_reports()[0].receiver.frames);
  // The burst explained last is the newest of the recording; received_since covers those before.
  const Outcome all = replay(8192, nullptr, 1);
  // One that waits through a silence of more than three seconds is dropped instead.
  EXPECT_EQ(explained.size() + counters.bursts_merged + counters.bursts_dropped,
            all.counters.bursts);
  EXPECT_LT(explained.back().received_since, explained.back().first);
  EXPECT_GT(explained.back().first, explained.front().last);
}

TEST(Pipeline, StopsWhileARecordingIsPlayed) {
  DescribingEstimator estimator;
  OrderedSink sink([](const Location&) {});
  std::vector<SourceWorker::Input> inputs(1);
  inputs[0].access_point = "ap1";
  inputs[0].source = std::make_unique<PacedSource>(
      PcapFileSource::open(std::string(kSite) + "device_los-ap1.pcap.gz").value(),
      std::make_shared<Pace>(1.0));
  Pipeline pipeline({}, std::move(inputs), estimator, sink);
  pipeline.start();
  pipeline.stop();
  EXPECT_TRUE(pipeline.finished());
  const EstimationCounters counters = pipeline.estimation_counters();
  EXPECT_EQ(counters.taken, counters.used + counters.in_flight);
  EXPECT_EQ(counters.in_flight, 0U);
}

}  // namespace
}  // namespace rayloc::pipeline_test
