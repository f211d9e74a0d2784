// A pipeline that continues another one reports the same results, burst by burst.
#include "daemon/pipeline/warm/warm_start.h"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "capture/source/pcap_source.h"
#include "daemon/messages/location_message.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/output/carried_message.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/playback/later_source.h"
#include "tests/support/test_paths.h"

namespace rayloc::warm_start_test {
namespace {

using std::chrono::milliseconds;

const std::string kSite = test::data_path("/sites/meeting_room/");
constexpr Timestamp kStart{std::chrono::seconds(1'718'000'000)};

// Lists all frames of each burst, at its beginning and at its end.
class DescribingEstimator : public Estimator {
 public:
  void estimate(const Burst& burst, Estimates& out) override {
    std::string text = std::to_string(burst.surplus) + " ";
    for (const CsiFrame& frame : burst.frames) {
      text += std::to_string(frame.access_point) + ":" + std::to_string(frame.sequence) + ":" +
              std::to_string(frame.time.time_since_epoch().count()) + " ";
    }
    for (const Timestamp time : {burst.first, burst.last}) {
      Location& location = out.locations.emplace_back();
      location.target.address = to_string(burst.transmitter);
      location.estimate.time = time;
      location.estimate.reason = text;
    }
  }
};

class Writer : public OrderedSink {
 public:
  Writer()
      : OrderedSink([this](const Location& location) {
          lines.emplace_back(location.estimate.time,
                             location_message(location).SerializeAsString());
        }) {}
  void carried(Carried&& carried) override { records.push_back(std::move(carried)); }

  std::vector<std::pair<Timestamp, std::string>> lines;
  std::vector<Carried> records;
};

struct ReplayCase {
  std::size_t sources = 3;
  Duration burst = milliseconds(200);
  std::size_t ring_frames = 8192;
  std::string recording = "device_los";
};

Writer replay(const ReplayCase& received, const WarmStart& start, Duration carry_every) {
  std::vector<SourceWorker::Input> inputs;
  for (std::size_t index = 0; index < received.sources; ++index) {
    const std::string id = "ap" + std::to_string(index + 1);
    SourceWorker::Input input;
    input.access_point = id;
    input.source =
        PcapFileSource::open(kSite + (received.recording + "-" + id + ".pcap.gz")).value();
    if (start.listen_from != Timestamp::min()) {
      input.source = std::make_unique<LaterSource>(std::move(input.source), start.listen_from);
    }
    input.receiver.access_point = index;
    inputs.push_back(std::move(input));
  }
  DescribingEstimator estimator;
  Writer sink;
  PipelineOptions options;
  options.burst.length = received.burst;
  options.ring_frames = received.ring_frames;
  options.overflow = Overflow::kWait;
  options.open = start.open;
  options.from = start.from;
  options.carry_every = carry_every;
  Pipeline pipeline(options, std::move(inputs), estimator, sink);
  pipeline.start();
  pipeline.wait();
  sink.finish();
  const EstimationCounters counters = pipeline.estimation_counters();
  EXPECT_EQ(counters.taken,
            counters.used + counters.surplus + counters.unwanted + counters.in_flight);
  EXPECT_EQ(counters.in_flight, 0U);
  return sink;
}

std::vector<std::pair<Timestamp, std::string>> from(
    Timestamp time, std::vector<std::pair<Timestamp, std::string>> lines) {
  std::erase_if(lines, [&](const auto& line) { return line.first < time; });
  return lines;
}

std::string text_behind(Timestamp done, const std::vector<Carried>& records) {
  std::string text;
  for (const Carried& record : records) {
    if (record.done > done) {
      text += carried_message(record).SerializeAsString();
    }
  }
  return text;
}

class WarmStartOf : public ::testing::TestWithParam<ReplayCase> {};

TEST_P(WarmStartOf, GoesOnWithTheSameBursts) {
  const Writer whole = replay(GetParam(), {}, milliseconds(230));
  ASSERT_GT(whole.records.size(), 20U);
  // A file that is cut anywhere, with and without seconds to listen to again.
  for (std::size_t i = 3; i < whole.records.size(); i += whole.records.size() / 4) {
    for (const Duration warm_up : {milliseconds(0), milliseconds(1500)}) {
      const auto start = warm_start(std::span(whole.records).first(i + 1), std::nullopt, warm_up);
      ASSERT_TRUE(start);
      EXPECT_EQ(start->from, whole.records[i].done);
      const Writer after = replay(GetParam(), *start, milliseconds(230));
      EXPECT_EQ(after.lines, from(start->from, whole.lines)) << i;
      // The next successor would receive the same records. Several records may have one `done`.
      EXPECT_EQ(text_behind(start->from, after.records), text_behind(start->from, whole.records))
          << i;
    }
  }
  // At any moment between two records.
  const Timestamp moment = whole.records[7].done + milliseconds(101);
  const auto start = warm_start(whole.records, moment, milliseconds(600));
  ASSERT_TRUE(start);
  EXPECT_EQ(replay(GetParam(), *start, {}).lines, from(moment, whole.lines));
}

TEST_P(WarmStartOf, RecordsAndQueuesMakeNoDifference) {
  ReplayCase received = GetParam();
  const Writer reference = replay(received, {}, {});
  EXPECT_TRUE(reference.records.empty());
  const Writer recorded = replay(received, {}, milliseconds(100));
  EXPECT_EQ(recorded.lines, reference.lines);
  received.ring_frames = 3;
  const Writer narrow = replay(received, {}, milliseconds(100));
  EXPECT_EQ(narrow.lines, reference.lines);
  EXPECT_EQ(text_behind({}, narrow.records), text_behind({}, recorded.records));
}

INSTANTIATE_TEST_SUITE_P(Recordings,
                         WarmStartOf,
                         ::testing::Values(ReplayCase{},
                                           ReplayCase{1},
                                           ReplayCase{2, milliseconds(1200)},
                                           ReplayCase{3, milliseconds(200), 8192, "walk"}));

TEST(WarmStart, ListensFromBeforeTheLongestSilence) {
  std::vector<Carried> records(20);
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].open.at = kStart + std::chrono::seconds(i);
    records[i].done = records[i].received = records[i].open.at - milliseconds(100);
    records[i].people = {{{}, i, records[i].done}};
  }
  const auto begin = [&] {
    return warm_start(records, std::nullopt, std::chrono::seconds(5))->open.at;
  };
  EXPECT_EQ(begin(), kStart + std::chrono::seconds(13));
  // The numbers of the last record, and the moments of the one from which it listens.
  const auto people = warm_start(records, std::nullopt, std::chrono::seconds(5))->carried->people;
  EXPECT_EQ(people[0].number, 19U);
  EXPECT_EQ(people[0].moment, records[13].done);
  records.back().received = kStart + std::chrono::seconds(15);
  EXPECT_EQ(begin(), kStart + std::chrono::seconds(10));
  // The whole recording where no record states the open bursts of that time.
  records.back().received = kStart + std::chrono::seconds(4);
  EXPECT_EQ(begin(), Timestamp::min());
}

TEST(WarmStart, WithoutRecordsListensForAWhile) {
  const auto start = warm_start({}, kStart, std::chrono::seconds(5));
  ASSERT_TRUE(start);
  EXPECT_EQ(start->open.at, kStart - std::chrono::seconds(5));
  EXPECT_TRUE(start->open.starts.empty());
  EXPECT_EQ(start->carried, nullptr);
}

TEST(WarmStart, RefusesAMomentBeforeTheRecords) {
  std::vector<Carried> records(1);
  records[0].done = kStart;
  EXPECT_FALSE(warm_start(records, kStart - milliseconds(1), std::chrono::seconds(5)));
}

}  // namespace
}  // namespace rayloc::warm_start_test
