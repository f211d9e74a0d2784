// Methods beside that of the site: they get its bursts, and it is as if they were not there.
#include "daemon/pipeline/compare/compared_method.h"

#include <future>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/source/pcap_source.h"
#include "daemon/live/output/site_output.h"
#include "daemon/messages/location_message.h"
#include "daemon/pipeline/compare/compared_estimator.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/ordered_sink.h"
#include "tests/support/eventually.h"
#include "tests/support/test_paths.h"

namespace rayloc::compared_method_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr auto kPatience = 60s;
const std::string kSite = test::data_path("/sites/meeting_room/");

// States of each burst which frames it had.
class DescribingEstimator : public Estimator {
 public:
  explicit DescribingEstimator(std::string method) : method_(std::move(method)) {}
  void estimate(const Burst& burst, Estimates& out) override {
    Location location;
    location.target.address = to_string(burst.transmitter);
    location.context.method = method_;
    location.estimate.time = burst.first + (burst.last - burst.first) / 2;
    for (const CsiFrame& frame : burst.frames) {
      double sum = 0.0;
      for (const std::complex<float>& value : frame.csi.values()) {
        sum += static_cast<double>(std::norm(value));
      }
      location.estimate.reason += std::to_string(frame.access_point) + ":" +
                                  std::to_string(frame.sequence) + ":" + std::to_string(sum) + " ";
    }
    out.locations.push_back(std::move(location));
  }

 private:
  const std::string method_;
};

// Goes on when the compared methods have explained what they were given.
class PatientEstimator : public DescribingEstimator {
 public:
  using DescribingEstimator::DescribingEstimator;
  void wait_for(const std::vector<std::unique_ptr<ComparedMethod>>& others) { others_ = &others; }
  void estimate(const Burst& burst, Estimates& out) override {
    for (const auto& other : *others_) {
      ASSERT_TRUE(eventually(kPatience, [&] { return other->counters().in_flight == 0; }));
    }
    DescribingEstimator::estimate(burst, out);
  }

 private:
  const std::vector<std::unique_ptr<ComparedMethod>>* others_ = nullptr;
};

// The locations of a replay of one access point's recording.
std::vector<Location> replay(Estimator& estimator) {
  std::vector<SourceWorker::Input> inputs(1);
  inputs[0].access_point = "ap1";
  inputs[0].source = PcapFileSource::open(kSite + "device_los-ap1.pcap.gz").value();
  inputs[0].receiver.access_point = 0;
  std::vector<Location> locations;
  OrderedSink sink([&](const Location& location) { locations.push_back(location); });
  PipelineOptions options;
  options.overflow = Overflow::kWait;
  Pipeline pipeline(options, std::move(inputs), estimator, sink);
  pipeline.start();
  pipeline.wait();
  sink.finish();
  return locations;
}

std::string bytes_of(const std::vector<Location>& locations) {
  std::string bytes;
  for (const Location& location : locations) {
    bytes += location_message(location).SerializeAsString() + "\n";
  }
  return bytes;
}

std::vector<std::string> texts_of(const std::vector<Location>& locations) {
  std::vector<std::string> texts;
  texts.reserve(locations.size());
  for (const Location& location : locations) {
    texts.push_back(location.estimate.reason);
  }
  return texts;
}

std::unique_ptr<ComparedMethod> make_method(std::unique_ptr<Estimator> estimator,
                                            ComparedMethod::Options options = {}) {
  std::vector<std::unique_ptr<Estimator>> estimators;
  estimators.push_back(std::move(estimator));
  options.name = options.name.empty() ? "other" : options.name;
  options.patience = kPatience;
  return std::make_unique<ComparedMethod>(std::move(options), std::move(estimators));
}

std::uint64_t accounted(const ComparedMethodCounters& counters) {
  return counters.explained + counters.dropped + counters.in_flight;
}

TEST(ComparedMethod, GetsTheBurstsOfTheFirstMethodWithoutChangingItsResults) {
  DescribingEstimator alone("first");
  const std::vector<Location> reference = replay(alone);
  ASSERT_GT(reference.size(), 20U);

  std::vector<std::unique_ptr<ComparedMethod>> others;
  others.push_back(make_method(std::make_unique<DescribingEstimator>("a"), {.name = "a"}));
  others.push_back(make_method(std::make_unique<DescribingEstimator>("b"), {.name = "b"}));
  std::map<std::string, std::vector<Location>> found;
  for (const auto& other : others) {
    other->start([&mine = found[other->name()]](Location&& location) {
      mine.push_back(std::move(location));
      return false;
    });
  }
  PatientEstimator first("first");
  first.wait_for(others);
  ComparedEstimator estimator(first, others);
  EXPECT_EQ(bytes_of(replay(estimator)), bytes_of(reference));
  for (const auto& other : others) {
    EXPECT_TRUE(eventually(kPatience, [&] { return other->counters().in_flight == 0; }));
    other->stop();
    EXPECT_EQ(texts_of(found[other->name()]), texts_of(reference));
    const ComparedMethodCounters counters = other->counters();
    EXPECT_EQ(counters.bursts, reference.size());
    EXPECT_EQ(counters.explained, reference.size());
    EXPECT_EQ(counters.no_fixes, reference.size());
    EXPECT_EQ(counters.dropped, 0U);
  }
}

// Is at its first burst until it is released.
class StuckEstimator : public Estimator {
 public:
  explicit StuckEstimator(std::shared_future<void> released) : released_(std::move(released)) {}
  void estimate(const Burst&, Estimates& out) override {
    released_.wait();
    out.locations.emplace_back();
  }

 private:
  const std::shared_future<void> released_;
};

TEST(ComparedMethod, AStuckMethodDelaysNoOtherAndIsCounted) {
  DescribingEstimator alone("first");
  const std::string reference = bytes_of(replay(alone));
  std::promise<void> release;
  std::vector<std::unique_ptr<ComparedMethod>> others;
  others.push_back(make_method(std::make_unique<StuckEstimator>(release.get_future().share())));
  others.front()->start([](Location&&) { return false; });
  DescribingEstimator first("first");
  ComparedEstimator estimator(first, others);
  EXPECT_EQ(bytes_of(replay(estimator)), reference);  // it ends although the other one does not
  ComparedMethodCounters counters = others.front()->counters();
  EXPECT_EQ(counters.explained, 0U);
  EXPECT_GT(counters.dropped, 10U);
  EXPECT_GE(counters.in_flight, 1U);
  EXPECT_EQ(counters.bursts, accounted(counters));
  release.set_value();
  others.front()->stop();
  counters = others.front()->counters();
  EXPECT_LE(counters.explained, 2U);
  EXPECT_EQ(counters.in_flight, 0U);
  EXPECT_EQ(counters.bursts, accounted(counters));
}

Burst burst_of(std::uint8_t device, Timestamp begin) {
  Burst burst;
  burst.transmitter = MacAddress{{0x02, 0, 0, 0, 0, device}};
  burst.first = burst.received_since = begin;
  burst.last = begin + 100ms;
  burst.frames.resize(1);
  burst.frames[0].time = begin;
  return burst;
}

constexpr Timestamp kBegin{1000s};

// Notes what it is asked, in order.
class NotingEstimator : public Estimator {
 public:
  explicit NotingEstimator(std::shared_ptr<std::vector<std::string>> notes)
      : notes_(std::move(notes)) {}
  void estimate(const Burst& burst, Estimates& out) override {
    notes_->push_back("burst " + to_string(burst.transmitter));
    out.locations.emplace_back();
    out.locations.back().estimate.position = Vec3d{1.0, 2.0, 3.0};
    out.events.emplace_back();
  }
  void advance(Timestamp time, const IsWaiting&, Estimates& out) override {
    notes_->push_back("silence " + std::to_string((time - kBegin) / 1s));
    out.locations.emplace_back();
    out.locations.back().tracked.emplace();
  }
  void restart(const std::string& reason, Estimates&) override { notes_->push_back(reason); }

 private:
  const std::shared_ptr<std::vector<std::string>> notes_;
};

TEST(ComparedMethod, TakesBurstsSilenceAndMovesInTheirOrder) {
  const auto notes = std::make_shared<std::vector<std::string>>();
  const auto method = make_method(std::make_unique<NotingEstimator>(notes));
  bool replaces = false;
  method->start([&](Location&&) { return std::exchange(replaces, true); });
  // Bursts that were added before the move are not explained after it.
  method->advance(kBegin + 5s);
  EXPECT_TRUE(eventually(kPatience, [&] { return method->counters().filtered == 1; }));
  method->restart("moved");
  method->add(burst_of(1, kBegin));
  EXPECT_TRUE(eventually(kPatience, [&] { return method->counters().explained == 1; }));
  method->advance(kBegin + 1s);
  EXPECT_TRUE(eventually(kPatience, [&] { return method->counters().filtered == 2; }));
  method->stop();
  EXPECT_THAT(*notes, ElementsAre("silence 5", "moved", "burst 02:00:00:00:00:01", "silence 1"));
  const ComparedMethodCounters counters = method->counters();
  EXPECT_EQ(counters.fixes, 1U);
  EXPECT_EQ(counters.no_fixes, 0U);
  EXPECT_EQ(counters.coalesced, 2U);  // all but the first
}

// Notes since when the transmitter of a burst has been received.
class SinceEstimator : public Estimator {
 public:
  explicit SinceEstimator(std::shared_ptr<std::vector<Timestamp>> since)
      : since_(std::move(since)) {}
  void estimate(const Burst& burst, Estimates&) override {
    since_->push_back(burst.received_since);
  }

 private:
  const std::shared_ptr<std::vector<Timestamp>> since_;
};

TEST(ComparedMethod, AfterASeekNoTransmitterHasWaited) {
  const auto since = std::make_shared<std::vector<Timestamp>>();
  const auto method =
      make_method(std::make_unique<SinceEstimator>(since), {.name = "other", .max_frames = 1});
  method->add(burst_of(1, kBegin + 10s));  // has to give way to the next
  method->add(burst_of(2, kBegin + 11s));
  EXPECT_EQ(method->counters().dropped, 1U);
  EXPECT_EQ(method->counters().in_flight, 1U);
  method->restart("moved");
  EXPECT_EQ(method->counters().dropped, 2U);
  EXPECT_EQ(method->counters().in_flight, 0U);
  method->add(burst_of(1, kBegin));
  method->start([](Location&&) { return false; });
  EXPECT_TRUE(eventually(kPatience, [&] { return method->counters().explained == 1; }));
  method->stop();
  EXPECT_THAT(*since, ElementsAre(kBegin));
  EXPECT_EQ(method->counters().bursts, accounted(method->counters()));
}

TEST(ComparedMethod, GetsOnlyTheBurstsOfDevicesThatItLocates) {
  const auto notes = std::make_shared<std::vector<std::string>>();
  const MacAddress wanted{{0x02, 0, 0, 0, 0, 2}};
  std::vector<std::unique_ptr<ComparedMethod>> others;
  others.push_back(make_method(
      std::make_unique<NotingEstimator>(notes),
      {.name = "other", .wants = [&](const MacAddress& mac) { return mac == wanted; }}));
  others.front()->start([](Location&&) { return false; });
  DescribingEstimator first("first");
  ComparedEstimator estimator(first, others);
  std::vector<Burst> bursts;
  bursts.push_back(burst_of(1, kBegin));
  bursts.push_back(burst_of(2, kBegin));
  estimator.release(std::move(bursts));
  EXPECT_TRUE(eventually(kPatience, [&] { return others.front()->counters().explained == 1; }));
  others.front()->stop();
  EXPECT_THAT(*notes, ElementsAre("burst 02:00:00:00:00:02"));
  EXPECT_EQ(others.front()->counters().bursts, 1U);
}

TEST(ComparedMethod, CountsBurstsAfterItsEnd) {
  const auto notes = std::make_shared<std::vector<std::string>>();
  const auto method = make_method(std::make_unique<NotingEstimator>(notes));
  method->start([](Location&&) { return false; });
  method->stop();
  method->add(burst_of(1, kBegin));
  EXPECT_THAT(*notes, IsEmpty());
  EXPECT_EQ(method->counters().dropped, 1U);
  EXPECT_EQ(method->counters().bursts, 1U);
}

Location location_of(const std::string& method, const std::string& target, Timestamp time) {
  Location location;
  location.context.method = method;
  location.target.address = target;
  location.estimate.time = time;
  return location;
}

TEST(ComparedMethod, DisplacesNothingOfTheSitesOwnInTheOutput) {
  SiteOutput::Options options;
  options.site = "office";
  options.max_waiting = 2;
  SiteOutput output(options);
  output.on_something([] {});
  output.location(location_of("first", "a", kBegin));
  output.location(location_of("first", "b", kBegin));
  EXPECT_FALSE(output.compared(location_of("x", "a", kBegin)));
  EXPECT_FALSE(output.compared(location_of("y", "a", kBegin)));
  EXPECT_TRUE(output.compared(location_of("y", "a", kBegin + 1s)));
  EXPECT_EQ(output.counters().coalesced, 0U);
  const SiteOutput::Waiting waiting = output.take();
  EXPECT_EQ(waiting.locations.size(), 2U);
  ASSERT_EQ(waiting.compared.size(), 2U);
  EXPECT_EQ(waiting.compared[0].location.context.method, "x");
  EXPECT_EQ(waiting.compared[1].location.estimate.time, kBegin + 1s) << "of its own method";
  EXPECT_EQ(waiting.compared[1].coalesced, 1U);
  const v1::Location message = compared_message(waiting.compared[0].location);
  EXPECT_EQ(message.event_id(), location_message(waiting.compared[0].location).event_id() + "-x");
}

}  // namespace
}  // namespace rayloc::compared_method_test
