#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "daemon/live/output/publisher_stage.h"
#include "daemon/live/publish/message_board.h"
#include "daemon/messages/last_messages.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/support/eventually.h"

namespace rayloc::field_publisher_stage_test {
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
  PublisherStage stage(std::move(*publisher), std::move(options));
  SiteOutput::Options site;
  site.site = "office";
  site.status = [&asked](Timestamp /*now*/) {
    ++*asked;
    return StatusMessages();
  };
  stage.add(stage.make_output(std::move(site)));
  stage.start();
  ASSERT_TRUE(eventually(std::chrono::seconds(60), [&] { return *asked > 3; }));
  stage.halt();
  const int before = *asked;
  EXPECT_TRUE(stage.progress().resting());
  EXPECT_EQ(*asked, before);
  asked.reset();
  stage.halt();
}

PublisherOptions on_any_port(const std::shared_ptr<LastMessages>& last) {
  PublisherOptions options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.site = "office";
  options.epoch = 5;
  options.last = last;
  return options;
}

SiteOutput::Options site_called(const std::string& name) {
  SiteOutput::Options options;
  options.site = name;
  options.board = std::make_shared<MessageBoard>(100);
  options.status = [](Timestamp /*now*/) { return StatusMessages(); };
  return options;
}

// The last message of that topic.
std::optional<v1::Envelope> last_of(const LastMessages& last, const std::string& topic) {
  for (const auto& [name, bytes] : last.matching({topic})) {
    v1::Envelope envelope;
    if (name == topic && envelope.ParseFromString(bytes)) {
      return envelope;
    }
  }
  return std::nullopt;
}

TEST(PublisherStage, NumbersSitesApartAndLetsOneGo) {
  const auto last = std::make_shared<LastMessages>(100);
  PublisherStage stage(Publisher::bind(on_any_port(last)).value(),
                       {.heartbeat = std::chrono::milliseconds(1),
                        .now = [] { return Timestamp(std::chrono::seconds(1718000000)); }});
  const auto office = stage.make_output(site_called("office"));
  const auto lab = stage.make_output(site_called("lab/2"));
  stage.add(office);
  stage.add(lab);
  ZoneEvent event;
  event.zone = "desk";
  for (int i = 0; i < 3; ++i) {
    office->event(ZoneEvent(event));
  }
  lab->event(ZoneEvent(event));
  stage.start();
  const auto sequence = [&](const std::string& topic) {
    const auto envelope = last_of(*last, topic);
    return envelope ? envelope->sequence() : 0;
  };
  ASSERT_TRUE(eventually(std::chrono::seconds(60), [&] {
    return sequence("v1/heartbeat/office/") > 2 && sequence("v1/heartbeat/lab%2F2/") > 2;
  }));
  EXPECT_EQ(sequence("v1/zone/office/desk/"), 3U);
  EXPECT_EQ(sequence("v1/zone/lab%2F2/desk/"), 1U);
  const auto heartbeat = last_of(*last, "v1/heartbeat/lab%2F2/");
  for (const v1::TopicClass& one : heartbeat->heartbeat().topic_classes()) {
    EXPECT_NE(one.prefix().find("/lab%2F2/"), std::string::npos) << one.prefix();
  }
  EXPECT_GT(office->options().board->revision(), 0U);

  lab->event(ZoneEvent(event));
  stage.remove(lab, "the site is gone");
  ASSERT_TRUE(eventually(std::chrono::seconds(60),
                         [&] { return last_of(*last, "v1/heartbeat/lab%2F2/")->has_goodbye(); }));
  EXPECT_EQ(sequence("v1/zone/lab%2F2/desk/"), 2U) << "what waited is said first";
  const std::uint64_t before = sequence("v1/heartbeat/office/");
  ASSERT_TRUE(eventually(std::chrono::seconds(60),
                         [&] { return sequence("v1/heartbeat/office/") > before + 2; }));
  stage.finish("end");
  EXPECT_TRUE(last_of(*last, "v1/heartbeat/office/")->has_goodbye());
}

TEST(LastMessagesOfSites, ASiteWithManyTopicsDisplacesNoneOfAnother) {
  LastMessages last(2);
  last.put("v1/location/office/a/", "1");
  for (const char* const leaf : {"a", "b", "c", "d"}) {
    last.put(std::string("v1/location/lab/") + leaf + "/", "1");
  }
  EXPECT_EQ(last.matching({"v1/location/office/"}).size(), 1U);
  EXPECT_EQ(last.matching({"v1/location/lab/"}).size(), 2U);
  EXPECT_EQ(last.matching({"v1/"}).front().first, "v1/location/lab/c/") << "in order over all";
}

}  // namespace
}  // namespace rayloc::field_publisher_stage_test
