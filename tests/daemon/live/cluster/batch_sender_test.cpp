#include "daemon/live/cluster/batch_sender.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/sealed_message.h"
#include "rayloc/v1/cluster.pb.h"
#include "tests/daemon/live/cluster/fake_broker.h"
#include "tests/daemon/live/cluster/some_batch.h"
#include "tests/support/eventually.h"

namespace rayloc::batch_sender_test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{20};

class CaptureNode : public ::testing::Test {
 protected:
  void open(BatchSender::Options options = {}) {
    auto role = CaptureRole::open(broker_, {"node.1", kSomeEpoch, std::move(options)});
    ASSERT_TRUE(role);
    role_ = std::move(*role);
    sender_ = *role_->add_site("lab 2");
    tap1_ = &sender_->tap("ap1");
    tap2_ = &sender_->tap("ap2");
    ASSERT_TRUE(sender_->start());
  }
  void receive(DatagramTap& tap, std::size_t count) {
    const Batch some = some_batch(++received_, {{"x", count}});
    const auto datagrams = some.parts[0].datagrams.datagrams();
    tap.tap(datagrams);
    tap.advance(some.parts[0].watermark);
  }
  std::vector<Batch> batches() const {
    std::vector<Batch> all;
    for (const BrokerMessage& message : broker_->stored()) {
      auto batch = decode_batch(message.data);
      EXPECT_TRUE(batch);
      all.push_back(std::move(*batch));
    }
    return all;
  }
  static std::uint64_t sum(const NumberedRing::Counts& counts) {
    std::uint64_t all = 0;
    for (const auto& [access_point, count] : counts) {
      all += count;
    }
    return all;
  }
  void expect_law() const {
    BatchSender::Counters counters = sender_->counters();
    for (const auto& [access_point, captured] : counters.captured) {
      EXPECT_EQ(captured,
                counters.ring.live[access_point] + counters.ring.marked[access_point] +
                    counters.ring.waiting[access_point]);
    }
  }
  bool all_live() const {
    return eventually(kPatience, [&] {
      const BatchSender::Counters counters = sender_->counters();
      return sum(counters.ring.live) + sum(counters.ring.marked) == sum(counters.captured) &&
             sum(counters.ring.waiting) == 0;
    });
  }

  std::shared_ptr<FakeBroker> broker_ = std::make_shared<FakeBroker>();
  std::unique_ptr<CaptureRole> role_;
  std::shared_ptr<BatchSender> sender_;
  DatagramTap* tap1_ = nullptr;
  DatagramTap* tap2_ = nullptr;
  std::uint64_t received_ = 0;
};

TEST_F(CaptureNode, PacksDatagramsOfAllAccessPointsIntoNumberedBatches) {
  open();
  receive(*tap1_, 3);
  receive(*tap2_, 2);
  ASSERT_TRUE(all_live());
  expect_law();
  const std::vector<Batch> all = batches();
  ASSERT_GE(all.size(), 1U);
  std::uint64_t number = 0;
  std::size_t datagrams = 0;
  for (const Batch& batch : all) {
    EXPECT_EQ(batch.epoch, kSomeEpoch);
    EXPECT_EQ(batch.number, ++number);
    for (const BatchPart& part : batch.parts) {
      datagrams += part.datagrams.entries.size();
    }
  }
  EXPECT_EQ(datagrams, 5U);
  EXPECT_EQ(broker_->stored()[0].subject, "rayloc.v1.csi.lab%202.node%2E1");
}

TEST_F(CaptureNode, ABatchIsFullAtSoManyDatagramsOrBytes) {
  BatchSender::Options options;
  options.max_datagrams = 4;
  options.max_bytes = 90;
  open(options);
  receive(*tap1_, 6);  // of 20, 21, ... bytes
  sender_->finish();
  expect_law();
  std::vector<std::size_t> sizes;
  for (const Batch& batch : batches()) {
    for (const BatchPart& part : batch.parts) {
      sizes.push_back(part.datagrams.entries.size());
    }
  }
  EXPECT_THAT(sizes, ::testing::ElementsAre(4, 2));
}

TEST_F(CaptureNode, ADatagramWaitsForOthersAndNotForTheTick) {
  BatchSender::Options options;
  options.tick = std::chrono::minutes(10);
  open(options);
  receive(*tap1_, 1);
  EXPECT_TRUE(all_live());
  receive(*tap1_, 1);
  EXPECT_TRUE(all_live());
}

TEST_F(CaptureNode, SendsTicksWithoutDatagrams) {
  open();
  EXPECT_TRUE(eventually(kPatience, [&] { return batches().size() >= 3; }));
  tap1_->advance(Timestamp(milliseconds(5000)));
  EXPECT_TRUE(eventually(kPatience, [&] { return !batches().back().parts.empty(); }));
  EXPECT_EQ(batches().back().parts[0].watermark, Timestamp(milliseconds(5000)));
}

TEST_F(CaptureNode, AnAbsentBrokerCausesOnlyAGapMark) {
  broker_->set_connected(false);
  BatchSender::Options options;
  options.limits.stale = milliseconds(50);
  open(options);
  receive(*tap1_, 7);
  ASSERT_TRUE(eventually(kPatience, [&] { return sum(sender_->counters().ring.marked) == 7; }));
  EXPECT_EQ(sender_->trouble(), "no broker answers");
  expect_law();
  broker_->set_connected(true);
  receive(*tap1_, 2);
  ASSERT_TRUE(eventually(kPatience, [&] { return !batches().empty(); }));
  const Batch first = batches()[0];
  ASSERT_EQ(first.gaps.size(), 1U);
  EXPECT_EQ(first.gaps[0].from, 1U);
  EXPECT_EQ(first.gaps[0].to + 1, first.number);
  EXPECT_EQ(first.gaps[0].datagrams.at("ap1"), 7U);
  ASSERT_TRUE(all_live());
  expect_law();
}

TEST_F(CaptureNode, ABrokerThatLosesMessagesAndAcknowledgementsGetsEachAtLeastOnce) {
  broker_->fate = [](std::uint64_t n) {
    return n % 3 == 0   ? FakeBroker::Fate::kLost
           : n % 3 == 1 ? FakeBroker::Fate::kAcknowledgementLost
                        : FakeBroker::Fate::kStored;
  };
  BatchSender::Options options;
  options.limits.patience = milliseconds(30);
  open(options);
  for (int i = 0; i < 10; ++i) {
    receive(*tap1_, 64);
  }
  ASSERT_TRUE(all_live());
  expect_law();
  std::map<std::uint64_t, std::size_t> datagrams;
  for (const Batch& batch : batches()) {
    for (const BatchPart& part : batch.parts) {
      datagrams[batch.number] = part.datagrams.entries.size();
    }
  }
  std::size_t all = 0;
  for (const auto& [number, count] : datagrams) {
    all += count;
  }
  EXPECT_EQ(all, 640U);
}

TEST_F(CaptureNode, ResendsBatchesThatAWorkerRequests) {
  broker_->fate = [](std::uint64_t n) {
    return n == 0 ? FakeBroker::Fate::kAcknowledgedAndLost : FakeBroker::Fate::kStored;
  };
  open();
  receive(*tap1_, 3);
  ASSERT_TRUE(all_live());
  v1::ResendRequest request;
  request.set_site("lab 2");
  request.set_epoch(kSomeEpoch);
  request.set_from_number(1);
  request.set_to_number(1);
  ASSERT_TRUE(broker_->publish(resend_subject("node.1"), "no request"));
  ASSERT_TRUE(broker_->publish(resend_subject("node.1"), seal(request)));
  EXPECT_TRUE(eventually(kPatience, [&] {
    const auto all = batches();
    return std::any_of(all.begin(), all.end(), [](const Batch& one) { return one.number == 1; });
  }));
  expect_law();
}

TEST_F(CaptureNode, ReleasesBatchesThatAnOutputConsumed) {
  open();
  receive(*tap1_, 3);
  ASSERT_TRUE(all_live());
  const std::uint64_t last = batches().back().number;
  v1::OutputRecord record;
  v1::NodePosition& node = *record.mutable_output()->mutable_resume()->add_nodes();
  node.set_node("node.1");
  node.set_epoch(kSomeEpoch + 9);  // of another start: not this one's
  node.set_number(last);
  ASSERT_TRUE(broker_->publish(output_again_subject("lab 2"), seal(record)));
  EXPECT_GE(sender_->counters().ring.kept, last);
  node.set_epoch(kSomeEpoch);
  const auto kept_before = sender_->counters().ring.kept;
  ASSERT_TRUE(broker_->publish(output_again_subject("lab 2"), seal(record)));
  EXPECT_LT(sender_->counters().ring.kept, kept_before);
}

TEST_F(CaptureNode, MakesTheStreamAgainWhenTheBrokerHasForgottenIt) {
  BatchSender::Options options;
  options.limits.patience = milliseconds(30);
  open(options);
  receive(*tap1_, 1);
  ASSERT_TRUE(all_live());
  broker_->forget_streams();
  receive(*tap1_, 5);
  ASSERT_TRUE(all_live());
  EXPECT_GT(sender_->counters().refused, 0U);
  EXPECT_EQ(sender_->trouble(), "");
  expect_law();
}

}  // namespace
}  // namespace rayloc::batch_sender_test
