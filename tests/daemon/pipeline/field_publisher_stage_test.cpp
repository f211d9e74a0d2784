#include <atomic>

#include <gtest/gtest.h>

#include "daemon/pipeline/publisher_stage.h"
#include "tests/support/eventually.h"

namespace rayloc {
namespace {

TEST(Field, PublisherStageAsksForNoStatusOnceItHasHalted) {
  PublisherOptions publishing;
  publishing.endpoint = "tcp://127.0.0.1:*";
  publishing.site = "office";
  publishing.epoch = 5;
  auto publisher = Publisher::bind(publishing);
  ASSERT_TRUE(publisher) << publisher.error().message;
  // As the pipeline of a start that came half-way: it goes before the stage does.
  auto asked = std::make_unique<std::atomic<int>>(0);
  PublisherStage::Options options;
  options.heartbeat = std::chrono::milliseconds(1);
  options.now = [] { return Timestamp(std::chrono::seconds(1718000000)); };
  options.status = [&asked](Timestamp /*now*/) {
    ++*asked;
    return StatusMessages();
  };
  PublisherStage stage(std::move(*publisher), std::move(options));
  stage.start();
  ASSERT_TRUE(eventually(std::chrono::seconds(60), [&] { return *asked > 3; }));
  stage.halt();
  const int before = *asked;
  EXPECT_TRUE(stage.progress().resting());
  EXPECT_EQ(*asked, before);
  asked.reset();
  stage.halt();
}

}  // namespace
}  // namespace rayloc
