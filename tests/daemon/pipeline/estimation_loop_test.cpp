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

}  // namespace
}  // namespace rayloc::estimation_loop_test
