// A crowd of strangers beside one device, through the whole pipeline. An estimate takes longer than
// there is time for all; its time is event time here, so that no machine is too slow for the test.
#include <atomic>
#include <map>
#include <thread>

#include <gtest/gtest.h>

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/pipeline.h"
#include "tests/support/wire_writer.h"

namespace rayloc::field_crowd_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint64_t kDevice = 0x02524c000001;
constexpr std::uint64_t kStrangers = 0x02524cff0000;
constexpr Duration kEstimateTime = milliseconds(130);
constexpr Duration kLength = seconds(6);
constexpr Duration kIdleStep = milliseconds(10);
const Timestamp kBegin{seconds(1718000000)};

// The time that the air and the estimator of the test share.
struct Clock {
  std::atomic<Duration::rep> elapsed = 0;
  std::atomic<bool> explaining = false;  // then the estimator moves it, else the air
  std::atomic<std::uint64_t> reads = 0;
  std::atomic<bool> over = false;  // nothing more comes

  Timestamp now() const { return kBegin + Duration(elapsed); }
};

void add(test::Recording& recording, std::uint64_t transmitter, Duration after) {
  test::WireFrame frame;
  frame.transmitter = transmitter;
  frame.rx_chains = {0};
  frame.sequence = static_cast<std::uint16_t>(recording.size());
  frame.sequence_control = static_cast<std::uint16_t>(frame.sequence << 4U);
  for (test::RecordedDatagram& datagram : test::write_axcsi(frame, kBegin + after)) {
    recording.push_back(std::move(datagram));
  }
}

// 20 frames a second of the device; a salvo of 255 strangers, then `more` new ones each 100 ms.
test::Recording crowd(int more) {
  test::Recording recording;
  std::uint64_t stranger = kStrangers;
  for (int i = 0; i < 255; ++i) {
    add(recording, stranger++, Duration::zero());
  }
  for (Duration after = milliseconds(1); after < kLength; after += milliseconds(50)) {
    add(recording, kDevice, after);
    for (int i = 0; i < more / 2; ++i) {
      add(recording, stranger++, after);
    }
  }
  return recording;
}

// Delivers the datagrams up to the time of the clock.
class Air : public DatagramSource {
 public:
  Air(test::Recording recording, Clock& clock) : recording_(std::move(recording)), clock_(clock) {}

  Expected<void> read(DatagramBatch& batch, Duration /*timeout*/) override {
    ++clock_.reads;
    batch.datagrams.clear();
    if (!clock_.explaining) {
      clock_.elapsed += kIdleStep.count();
      std::this_thread::sleep_for(milliseconds(1));  // for the frames before to be taken
    }
    const Timestamp now = clock_.now();
    for (; next_ < recording_.size() && recording_[next_].time < now; ++next_) {
      batch.datagrams.push_back(recording_[next_].view());
    }
    counters_.received += batch.datagrams.size();
    counters_.delivered += batch.datagrams.size();
    batch.watermark = now;
    batch.ended = next_ == recording_.size();
    clock_.over = batch.ended;
    return {};
  }
  SourceCounters counters() const override { return counters_; }
  std::string description() const override { return "air"; }

 private:
  const test::Recording recording_;
  Clock& clock_;
  std::size_t next_ = 0;
  SourceCounters counters_;
};

// Takes kEstimateTime for an estimate, during which the air continues.
class BusyEstimator : public Estimator {
 public:
  BusyEstimator(Clock& clock, Rank device) : clock_(clock), device_(device) {}

  void estimate(const Burst& burst, Estimates& out) override {
    clock_.explaining = true;
    clock_.elapsed += kEstimateTime.count();
    // After a read that was under way when the clock moved, two reads happen at the new time.
    const std::uint64_t reads = clock_.reads;
    while (clock_.reads < reads + 3 && !clock_.over) {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
    ++explained_[burst.transmitter];
    if (!clock_.over) {  // then there is time for all
      oldest_ = std::max(oldest_, clock_.now() - burst.last);
    }
    Location location;
    location.estimate.time = burst.first;
    out.locations.push_back(std::move(location));
    clock_.explaining = false;
  }
  Rank rank(const MacAddress& transmitter) const override {
    return transmitter == device() ? device_ : Rank::kOther;
  }

  static MacAddress device() { return {{0x02, 0x52, 0x4c, 0, 0, 1}}; }
  std::size_t of_device() const { return explained_.count(device()) ? explained_.at(device()) : 0; }
  std::size_t transmitters() const { return explained_.size(); }
  Duration oldest() const { return oldest_; }

 private:
  Clock& clock_;
  const Rank device_;
  std::map<MacAddress, std::size_t> explained_;
  Duration oldest_{};
};

struct Outcome {
  std::size_t of_device = 0;
  std::size_t transmitters = 0;
  Duration oldest{};
  EstimationCounters counters;
};

Outcome run(int more, Rank device, Overflow overflow = Overflow::kDropOldest) {
  Clock clock;
  BusyEstimator estimator(clock, device);
  OrderedSink sink([](const Location&) {});
  std::vector<SourceWorker::Input> inputs(1);
  inputs[0].access_point = "ap1";
  inputs[0].source = std::make_unique<Air>(crowd(more), clock);
  PipelineOptions options;
  options.overflow = overflow;
  Pipeline pipeline(options, std::move(inputs), estimator, sink);
  pipeline.start();
  pipeline.wait();
  const EstimationCounters counters = pipeline.estimation_counters();
  EXPECT_EQ(counters.taken,
            counters.used + counters.surplus + counters.unwanted + counters.refused +
                counters.merged + counters.dropped + counters.in_flight);
  EXPECT_EQ(counters.in_flight, 0U);
  EXPECT_EQ(counters.bursts_in_flight, 0U);
  return {estimator.of_device(), estimator.transmitters(), estimator.oldest(), counters};
}

// The number of bursts of 200 ms of the device when no other one transmits.
constexpr std::size_t kBurstsOfDevice = 30;

TEST(Field, PipelineLocatesAListedDeviceInACrowdNearlyAsOftenAsAlone) {
  for (const Rank rank : {Rank::kListed, Rank::kTracked}) {
    for (const int more : {0, 20}) {
      const Outcome outcome = run(more, rank);
      // It leaves every fourth place to them, and on a busy machine waits for the one after it.
      EXPECT_GE(outcome.of_device, kBurstsOfDevice * 7 / 10) << more << " strangers each 100 ms";
      EXPECT_LE(outcome.of_device, kBurstsOfDevice + 1);
      EXPECT_GT(outcome.transmitters, 5U);  // there is some time left for the others
      EXPECT_GT(outcome.counters.bursts_dropped, 200U);
      // A stranger may be explained together with the device.
      EXPECT_LE(outcome.oldest, seconds(3) + 3 * kEstimateTime);
    }
  }
}

TEST(Field, PipelineReplaysACrowdWithoutDroppingAnybody) {
  const Outcome outcome = run(0, Rank::kListed, Overflow::kWait);
  EXPECT_EQ(outcome.transmitters, 256U);
  EXPECT_EQ(outcome.counters.bursts_dropped, 0U);
  EXPECT_EQ(outcome.counters.bursts_merged, 0U);
  EXPECT_EQ(outcome.counters.used + outcome.counters.surplus, outcome.counters.taken);
}

}  // namespace
}  // namespace rayloc::field_crowd_test
