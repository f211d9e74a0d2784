#include "daemon/pipeline/estimation_loop.h"

#include <chrono>
#include <map>
#include <vector>

#include <gmock/gmock.h>

#include "daemon/pipeline/estimates.h"

namespace rayloc::estimation_loop_test {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr MacAddress kFirst{{0x02, 0, 0, 0, 0, 1}};
constexpr MacAddress kSecond{{0x02, 0, 0, 0, 0, 2}};

Timestamp at(int ms) { return Timestamp(std::chrono::seconds(1000) + milliseconds(ms)); }

// Notes the processed bursts, and at each advance() the transmitters that wait.
class NotingEstimator : public Estimator {
 public:
  void estimate(const Burst& burst, Estimates& out) override {
    explained.push_back(burst.transmitter);
    out.locations.emplace_back().estimate.time = burst.first;
  }
  void advance(Timestamp /*time*/, const IsWaiting& is_waiting, Estimates& /*out*/) override {
    std::vector<MacAddress>& some = waiting[explained.size()];
    some.clear();
    for (const MacAddress& transmitter : {kFirst, kSecond}) {
      if (is_waiting(transmitter)) {
        some.push_back(transmitter);
      }
    }
  }
  Rank rank(const MacAddress& /*transmitter*/) const override { return Rank::kListed; }

  std::vector<MacAddress> explained;
  std::map<std::size_t, std::vector<MacAddress>> waiting;  // by the number of processed bursts
};

class NoSink : public LocationSink {
 public:
  void location(Location&& /*location*/) override {}
};

// A burst of each of the two transmitters, of one frame, and the end of the source.
void put_two_bursts(FrameMailbox& mailbox) {
  std::vector<CsiFrame> frames(2);
  frames[0].transmitter = kFirst;
  frames[0].time = at(0);
  frames[1].transmitter = kSecond;
  frames[1].time = at(10);
  mailbox.put(0, frames, at(1000));
  mailbox.end(0);
}

NotingEstimator run(Overflow overflow) {
  FrameMailbox mailbox(1, 8, overflow);
  put_two_bursts(mailbox);
  NotingEstimator estimator;
  NoSink sink;
  PipelineOptions options;
  options.overflow = overflow;
  options.bursts_at_once = 1;
  EstimationLoop loop(options, estimator, sink, mailbox);
  while (loop.step(false) == EstimationLoop::Step::kMore) {
  }
  return estimator;
}

TEST(EstimationLoop, LiveTheEstimatorGetsTheTransmittersThatWait) {
  const NotingEstimator estimator = run(Overflow::kDropOldest);
  EXPECT_THAT(estimator.explained, ElementsAre(kFirst, kSecond));
  EXPECT_THAT(estimator.waiting, ElementsAre(Pair(1U, ElementsAre(kSecond)), Pair(2U, IsEmpty())));
}

// Its silence must depend on the frames alone.
TEST(EstimationLoop, InAReplayNoTransmitterWaits) {
  const NotingEstimator estimator = run(Overflow::kWait);
  EXPECT_THAT(estimator.explained, ElementsAre(kFirst, kSecond));
  EXPECT_THAT(estimator.waiting, ElementsAre(Pair(1U, IsEmpty()), Pair(2U, IsEmpty())));
}

// As a tracker: reports a prediction each 100 ms while a transmitter is silent.
class PredictingEstimator : public Estimator {
 public:
  void estimate(const Burst& burst, Estimates& out) override {
    if (const auto known = due_.find(burst.transmitter); known != due_.end()) {
      predict(known->second, burst.received_since, out);
    }
    out.locations.emplace_back().estimate.time = burst.first;
    due_[burst.transmitter] = burst.first + milliseconds(100);
  }
  void advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) override {
    for (auto& [transmitter, due] : due_) {
      if (!is_waiting(transmitter)) {
        predict(due, time, out);
      }
    }
  }
  Rank rank(const MacAddress& /*transmitter*/) const override { return Rank::kListed; }

 private:
  static void predict(Timestamp& due, Timestamp until, Estimates& out) {
    for (; due < until; due += milliseconds(100)) {
      out.locations.emplace_back().estimate.time = due;
    }
  }

  std::map<MacAddress, Timestamp> due_;
};

// Counts the locations that precede what was promised.
class PromiseSink : public LocationSink {
 public:
  void location(Location&& location) override {
    ++locations;
    late += location.estimate.time < promised ? 1U : 0U;
  }
  void advance(Timestamp time) override {
    is_monotonic = is_monotonic && time >= promised;
    promised = time;
  }

  std::size_t locations = 0;
  std::size_t late = 0;
  bool is_monotonic = true;
  Timestamp promised = Timestamp::min();
};

void step_all(EstimationLoop& loop) {
  while (loop.step(false) == EstimationLoop::Step::kMore) {
  }
}

struct Sent {
  MacAddress transmitter;
  int ms = 0;
};

// A frame for each, and the promise that no older ones follow.
void put(FrameMailbox& mailbox, const std::vector<Sent>& all, Timestamp safe_time) {
  std::vector<CsiFrame> frames;
  for (const Sent& sent : all) {
    CsiFrame& frame = frames.emplace_back();
    frame.transmitter = sent.transmitter;
    frame.time = at(sent.ms);
  }
  mailbox.put(0, frames, safe_time);
}

class Promises : public ::testing::TestWithParam<Overflow> {};

// The first transmitter is silent for a second. Its silence was not reported yet when its next
// burst began to wait for that of the second.
TEST_P(Promises, NoLocationPrecedesThePromiseWhileATransmitterWaits) {
  FrameMailbox mailbox(1, 8, GetParam());
  PredictingEstimator estimator;
  PromiseSink sink;
  PipelineOptions options;
  options.overflow = GetParam();
  options.bursts_at_once = 1;
  EstimationLoop loop(options, estimator, sink, mailbox);
  put(mailbox, {{kFirst, 0}, {kSecond, 10}}, at(500));
  step_all(loop);
  EXPECT_EQ(sink.locations, 2U);
  put(mailbox, {{kSecond, 600}, {kFirst, 1000}}, at(1500));
  step_all(loop);
  // Predictions from 100 to 900 ms of the first, and from 110 to 510 ms of the second, and of the
  // latter again from 700 to 900 ms.
  EXPECT_EQ(sink.locations, 4U + 9 + 5 + 3);
  EXPECT_EQ(sink.late, 0U);
  EXPECT_TRUE(sink.is_monotonic);
  EXPECT_EQ(sink.promised, at(1000)) << "nothing waits any more";
}

INSTANTIATE_TEST_SUITE_P(Overflow,
                         Promises,
                         ::testing::Values(Overflow::kDropOldest, Overflow::kWait));

}  // namespace
}  // namespace rayloc::estimation_loop_test
