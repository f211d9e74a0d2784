// Tests the model and the view of `rayloc top`.
#include <algorithm>
#include <iterator>
#include <sstream>

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "daemon/cli/feed/age_text.h"
#include "daemon/cli/feed/top_model.h"
#include "daemon/cli/feed/top_view.h"
#include "daemon/cli/terminal/text_table.h"

namespace rayloc::cli::top_view_test {
namespace {

using namespace std::chrono_literals;

constexpr TopModel::Clock::time_point kStart{1000s};

v1::Envelope parsed(const std::string& text) {
  v1::Envelope envelope;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &envelope)) << text;
  return envelope;
}

v1::Envelope location(std::uint64_t sequence, int sent, const std::string& kind) {
  v1::Envelope envelope =
      parsed("epoch: 1 sent { seconds: " + std::to_string(sent) + " } location { kind: " + kind +
             " mode: FIX_MODE_2D target { track: 4 } position { x: 1 } }");
  envelope.set_sequence(sequence);
  return envelope;
}

v1::Envelope heartbeat(int time, int received) {
  return parsed(
      "epoch: 1 sequence: " + std::to_string(time) + " sent { seconds: " + std::to_string(time) +
      " } heartbeat { time { seconds: " + std::to_string(time) +
      " } sources { access_point: 'ap1' counters { received: " + std::to_string(received) +
      " } } }");
}

std::string text_of(const TopModel& model, TopModel::Clock::time_point now) {
  std::string text;
  for (const std::string& line : top_lines(model, now)) {
    text += line + "\n";
  }
  return text;
}

constexpr const char* kFiltered = "LOCATION_KIND_FILTERED";
constexpr const char* kSnapshot = "LOCATION_KIND_SNAPSHOT";

TEST(TopModel, ComputesRatesFromReceivedMessages) {
  TopModel model;
  for (int i = 0; i < 50; ++i) {  // ten a second
    model.add("t", location(static_cast<std::uint64_t>(i) + 1, 100, kFiltered), kStart + i * 100ms);
  }
  const TopModel::Stream& stream = TopModel::shown(model.targets().at("person-4"));
  EXPECT_DOUBLE_EQ(TopModel::rate(stream, kStart + 4900ms), 10.0);
  EXPECT_DOUBLE_EQ(TopModel::rate(stream, kStart + 20s), 0.0);
  EXPECT_FALSE(model.datagram_rate("ap1"));
  model.add("h", heartbeat(100, 1000), kStart);
  EXPECT_FALSE(model.datagram_rate("ap1"));
  model.add("h", heartbeat(102, 1500), kStart);
  EXPECT_EQ(model.datagram_rate("ap1"), 250.0);
  EXPECT_FALSE(model.datagram_rate("ap2"));
}

TEST(TopModel, MeasuresAgesByTheClockOfTheDaemon) {
  TopModel model;
  model.add("t", location(1, 100, kFiltered), kStart);
  model.add("h", heartbeat(107, 0), kStart + 7s);
  const std::string text = text_of(model, kStart + 8s);
  EXPECT_NE(text.find("  8.0 s  "), std::string::npos) << text;
  EXPECT_NE(text_of(model, kStart + 12s).find("NO HEARTBEAT FOR 5.0 s"), std::string::npos);
}

TEST(TopModel, ShowsSnapshotsWhenNothingIsFilteredAnyMore) {
  TopModel model;
  model.add("t", location(1, 100, kFiltered), kStart);
  model.add("t", location(2, 104, kSnapshot), kStart);
  const auto shown = [&] { return TopModel::shown(model.targets().at("person-4")).last.kind(); };
  EXPECT_EQ(shown(), v1::LOCATION_KIND_FILTERED);
  model.add("t", location(3, 106, kSnapshot), kStart);
  EXPECT_EQ(shown(), v1::LOCATION_KIND_SNAPSHOT);
}

TEST(TopModel, CountsLossesAndForgetsWithANewStart) {
  TopModel model;
  model.add("t", location(1, 100, kFiltered), kStart);
  model.add("t", location(5, 100, kFiltered), kStart);
  model.add("z",
            parsed("epoch: 1 sequence: 1 zone { zone: 'desk' occupancy: 2 inside { track: 4 } "
                   "inside { mac: 'm' name: 'phone' } }"),
            kStart);
  EXPECT_EQ(model.lost(), 3U);
  EXPECT_NE(text_of(model, kStart).find("desk       2  person-4 phone\n"), std::string::npos)
      << text_of(model, kStart);
  model.add("h", parsed("epoch: 2 sequence: 1 heartbeat {}"), kStart);
  EXPECT_EQ(model.restarts(), 1U);
  EXPECT_TRUE(model.targets().empty());
  EXPECT_TRUE(model.zones().empty());
  model.add("h", parsed("epoch: 2 sequence: 2 goodbye { reason: 'SIGTERM' }"), kStart);
  EXPECT_NE(text_of(model, kStart).find("stopped: SIGTERM"), std::string::npos);
}

TEST(TopModel, ForgetsTheSilentAndBoundsItsMemory) {
  TopModel model;
  for (std::size_t i = 0; i < TopModel::kMaxTargets + 10; ++i) {
    v1::Envelope each = location(i + 1, 100, kFiltered);
    each.mutable_location()->mutable_target()->set_track(i);
    model.add("t", each, kStart + std::chrono::milliseconds(i));
  }
  EXPECT_EQ(model.targets().size(), TopModel::kMaxTargets);
  EXPECT_FALSE(model.targets().contains("person-9"));
  model.add("h", heartbeat(100, 0), kStart + TopModel::kForgetAfter + 1h);
  EXPECT_TRUE(model.targets().empty());
}

TEST(TopView, CountsPeopleWherePersonTrackingIsOn) {
  TopModel model;
  v1::Envelope beat = heartbeat(100, 0);
  model.add("h", beat, kStart);
  EXPECT_EQ(text_of(model, kStart).find("people "), std::string::npos) << text_of(model, kStart);
  v1::PersonTrackerCounters& people = *beat.mutable_heartbeat()->mutable_person_tracker();
  people.set_tracks(2);
  people.set_begun(7);
  people.set_lost(5);
  people.set_used(31);
  people.set_moments(40);
  model.add("h", beat, kStart);
  EXPECT_NE(
      text_of(model, kStart).find("people      2 now, 7 begun, 5 lost; seen in 31 of 40 moments\n"),
      std::string::npos)
      << text_of(model, kStart);
}

// An ordinary terminal has eighty columns.
TEST(TopView, FitsIntoEightyColumns) {
  TopModel model;
  model.add("t",
            parsed("epoch: 1 sequence: 1 sent { seconds: 100 } location { "
                   "kind: LOCATION_KIND_FILTERED mode: FIX_MODE_PREDICTED "
                   "track_state: TRACK_STATE_TENTATIVE accuracy_m: 12.25 accuracy_confidence: 0.95 "
                   "target { mac: '02:52:4c:00:00:01' name: 'the phone of the kitchen' } "
                   "position { x: -11.25 y: -10.75 z: 1.2 } }"),
            kStart);
  model.add("z",
            parsed("epoch: 1 sequence: 1 zone { zone: 'kitchen' occupancy: 1 "
                   "inside { mac: '02:52:4c:00:00:01' } }"),
            kStart);
  v1::Envelope beat = heartbeat(100, 123'456'789);
  v1::Heartbeat& body = *beat.mutable_heartbeat();
  body.mutable_sources(0)->set_status(v1::SOURCE_STATUS_RECEIVING);
  body.mutable_sources(0)->mutable_counters()->set_frames_complete(123'456'789);
  body.mutable_estimation()->set_fixes(123'456'789);
  body.mutable_publisher()->set_published(123'456'789);
  model.add("h", beat, kStart);
  std::string text;
  for (const std::string& line : top_lines(model, kStart, 80)) {
    EXPECT_LE(text_width(line), 80U) << line;
    text += line + "\n";
  }
  for (const char* part : {"02:52:4c:00:00:01",
                           "-11.25",
                           "-10.75",
                           "12.25 m 95 %",
                           "kitchen",
                           "tentative",
                           "receiving",
                           "partial",
                           "times",
                           "slow"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  EXPECT_EQ(text.find("mode"), std::string::npos) << text;
  EXPECT_NE(text_of(model, kStart).find("the phone of the kitchen"), std::string::npos);
}

// 0.9 is not yet inside, and 0.1 not yet outside.
TEST(TopView, ListsZoneMembersFromZoneEventsOnly) {
  TopModel model;
  for (const auto& [track, probability] : {std::pair{4, 0.9}, {5, 0.1}}) {
    v1::Envelope each = location(static_cast<std::uint64_t>(track), 100, kFiltered);
    each.mutable_location()->mutable_target()->set_track(static_cast<std::uint64_t>(track));
    v1::ZoneProbability& zone = *each.mutable_location()->add_zones();
    zone.set_zone("desk");
    zone.set_probability(probability);
    model.add(std::to_string(track), each, kStart);
  }
  model.add("z", parsed("epoch: 1 sequence: 1 zone { zone: 'desk' inside { track: 5 } }"), kStart);
  model.add("y", parsed("epoch: 1 sequence: 1 zone { zone: 'door' inside { track: 5 } }"), kStart);
  EXPECT_EQ(model.zones_of("person-4"), std::vector<std::string>{});
  EXPECT_EQ(model.zones_of("person-5"), (std::vector<std::string>{"desk", "door"}));
  const std::string text = text_of(model, kStart);
  EXPECT_NE(text.find("  desk door\n"), std::string::npos) << text;
  model.add("z", parsed("epoch: 1 sequence: 2 zone { zone: 'desk' }"), kStart);
  EXPECT_EQ(model.zones_of("person-5"), std::vector<std::string>{"door"});
}

// As the live map counts (tests/e2e/map_modules_test.js).
TEST(TopView, CountsFramesWithoutAnEstimateAsLost) {
  TopModel model;
  model.add("h",
            parsed("epoch: 1 sequence: 1 heartbeat { sources { access_point: 'ap1' "
                   "status: SOURCE_STATUS_RECEIVING counters { received: 100 frames_complete: 60 "
                   "frames_partial: 7 late: 2 kernel_drops: 3 ring_dropped: 4 frames_dropped: 1 "
                   "rejected { key: 'too_short' value: 5 } "
                   "rejected { key: 'unknown_format' value: 6 } } } }"),
            kStart);
  std::vector<std::vector<std::string>> rows;
  for (const std::string& line : top_lines(model, kStart)) {
    std::istringstream words(line);
    rows.emplace_back(std::istream_iterator<std::string>(words),
                      std::istream_iterator<std::string>());
  }
  const auto row = std::find_if(
      rows.begin(), rows.end(), [](const auto& each) { return !each.empty() && each[0] == "ap1"; });
  ASSERT_NE(row, rows.end());
  EXPECT_EQ(*row,
            (std::vector<std::string>{"ap1", "receiving", "100", "-", "67", "7", "11", "10", "-"}));
}

TEST(TopModel, CountsNoRateOfRepeatedMessages) {
  TopModel model;
  model.add("t", location(1, 100, kFiltered), kStart, true);
  const TopModel::Stream& stream = TopModel::shown(model.targets().at("person-4"));
  EXPECT_EQ(TopModel::rate(stream, kStart), 0.0);
  model.add("t", location(2, 101, kFiltered), kStart + 1s);
  EXPECT_GT(TopModel::rate(TopModel::shown(model.targets().at("person-4")), kStart + 1s), 0.0);
}

TEST(TopView, ShowsWarningsWithTheirReasons) {
  TopModel model;
  v1::Envelope suspect = location(1, 100, kFiltered);
  v1::Quality& quality = *suspect.mutable_location()->mutable_quality();
  quality.add_warnings("right beside the transmitter");
  quality.set_ambiguous(true);
  model.add("t", suspect, kStart);
  const auto source = [](int sequence, const std::string& rest) {
    return parsed("epoch: 1 sequence: " + std::to_string(sequence) +
                  " source { access_point: 'ap1' " + rest + " }");
  };
  model.add(
      "s", source(1, "status: SOURCE_STATUS_FAILED detail: 'no such interface: mon0'"), kStart);
  EXPECT_NE(text_of(model, kStart)
                .find("\nwarning: person-4: right beside the transmitter\n"
                      "warning: person-4: another place is nearly as likely\n"
                      "ap1 failed: no such interface: mon0\n"),
            std::string::npos)
      << text_of(model, kStart);
  model.add("t", location(2, 101, kFiltered), kStart);
  model.add("s", source(2, "status: SOURCE_STATUS_RECEIVING"), kStart);
  EXPECT_EQ(text_of(model, kStart).find("warning"), std::string::npos) << text_of(model, kStart);
  EXPECT_EQ(text_of(model, kStart).find("ap1"), std::string::npos) << text_of(model, kStart);
}

TEST(TopView, ReportsThatNoHeartbeatHasArrived) {
  EXPECT_EQ(text_of(TopModel(), kStart), "no heartbeat yet\n");
}

TEST(Field, TopShowsWhyLessIsLocated) {
  TopModel model;
  v1::Envelope envelope = heartbeat(10, 1);
  envelope.mutable_heartbeat()->add_warnings("the site is not calibrated");
  envelope.mutable_heartbeat()->add_calibration_warnings("residual_drift: ap1");
  model.add("v1/heartbeat/s", envelope, kStart);
  const std::string text = text_of(model, kStart);
  EXPECT_NE(text.find("warning: the site is not calibrated\nwarning: residual_drift: ap1\n"),
            std::string::npos)
      << text;
}

TEST(Field, AgesAreRounded) {
  EXPECT_EQ(age_text(0.023330128), "0.0 s");
  EXPECT_EQ(age_text(-0.1), "0.0 s");
  EXPECT_EQ(age_text(59.6), "60 s");
  EXPECT_EQ(age_text(600.0), "10 min");
  EXPECT_EQ(age_text(86'400.0), "24 h");
}

}  // namespace
}  // namespace rayloc::cli::top_view_test
