#include "daemon/pipeline/zone_watch.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "daemon/publish/proto_time.h"

namespace rayloc {
namespace {

constexpr Timestamp kStart{std::chrono::seconds(1'718'000'000)};

Timestamp at(double seconds) { return kStart + from_seconds(seconds); }

// Enters from 0.7 after 0.5 s, leaves from 0.3 after 1 s, dwells after 10 s.
std::vector<SiteZone> zones(int count = 1) {
  std::vector<SiteZone> all;
  for (int i = 0; i < count; ++i) {
    SiteZone zone;
    zone.name = i == 0 ? "desk" : "door";
    zone.polygon = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    all.push_back(zone);
  }
  return all;
}

v1::Location estimate(double seconds, const std::string& mac, std::vector<double> probability) {
  v1::Location location;
  location.set_kind(v1::LOCATION_KIND_FILTERED);
  location.set_track_state(v1::TRACK_STATE_CONFIRMED);
  *location.mutable_time() = to_proto(at(seconds));
  location.mutable_target()->set_mac(mac);
  for (const double p : probability) {
    location.add_zones()->set_probability(p);
  }
  return location;
}

v1::Location lost(double seconds, const std::string& mac) {
  v1::Location location = estimate(seconds, mac, {});
  location.set_track_state(v1::TRACK_STATE_LOST);
  return location;
}

// "a entered 0.5 (1 inside)", one a line.
std::string lines(const std::vector<v1::ZoneEvent>& events) {
  std::string text;
  for (const v1::ZoneEvent& event : events) {
    const double time = to_seconds(from_proto(event.time()) - kStart);
    text += event.target().mac() + " " +
            (event.kind() == v1::ZONE_EVENT_KIND_ENTERED ? "entered "
             : event.kind() == v1::ZONE_EVENT_KIND_LEFT  ? "left "
                                                         : "dwelled ") +
            event.zone() + " " + std::to_string(std::lround(time * 1000)) + " (" +
            std::to_string(event.occupancy()) + " inside)\n";
    EXPECT_EQ(event.inside_size(), static_cast<int>(event.occupancy()));
    EXPECT_EQ(event.has_dwell(), event.kind() != v1::ZONE_EVENT_KIND_ENTERED);
    EXPECT_EQ(event.reason().empty(), event.kind() != v1::ZONE_EVENT_KIND_LEFT);
  }
  return text;
}

std::vector<v1::ZoneEvent> events_of(ZoneWatch& watch, double until) {
  std::vector<v1::ZoneEvent> events;
  watch.advance(at(until), events);
  return events;
}

// An estimate each 100 ms from `from` on, as many as there are probabilities.
void see_all(ZoneWatch& watch, double from, const std::vector<double>& probabilities) {
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    watch.see(estimate(from + 0.1 * static_cast<double>(i), "a", {probabilities[i]}));
  }
}

TEST(ZoneWatch, EntersAndLeavesWithHysteresis) {
  ZoneWatch watch(zones());
  see_all(watch, 0.0, std::vector<double>(7, 0.9));   // enters at 0.5
  see_all(watch, 0.7, std::vector<double>(20, 0.5));  // between the thresholds: stays
  see_all(watch, 2.7, std::vector<double>(9, 0.1));   // for less than a second
  see_all(watch, 3.6, {0.5});
  EXPECT_EQ(lines(events_of(watch, 3.7)), "a entered desk 500 (1 inside)\n");
  see_all(watch, 3.7, std::vector<double>(15, 0.3));  // leaves at 4.7
  const std::vector<v1::ZoneEvent> left = events_of(watch, 9.0);
  EXPECT_EQ(lines(left), "a left desk 4700 (0 inside)\n");
  EXPECT_DOUBLE_EQ(to_seconds(from_proto(left[0].dwell())), 4.2);
  EXPECT_EQ(left[0].probability(), 0.3);
  EXPECT_EQ(left[0].reason(), "its probability was at most 0.3 for 1 s");
  EXPECT_EQ(left[0].event_id(), "a-1718000004700000000-zone-desk-left");
}

TEST(ZoneWatch, IgnoresOneWhoOnlyPassesTheEdge) {
  ZoneWatch watch(zones());
  for (int i = 0; i < 20; ++i) {  // above for 0.4 s, then below, again and again
    see_all(watch, 0.6 * i, {0.9, 0.9, 0.9, 0.9, 0.9, 0.69});
  }
  EXPECT_EQ(lines(events_of(watch, 100.0)), "");
}

TEST(ZoneWatch, SaysOnceForEachStayThatATargetDwells) {
  ZoneWatch watch(zones());
  see_all(watch, 0.0, std::vector<double>(250, 0.9));
  see_all(watch, 25.0, std::vector<double>(11, 0.0));
  see_all(watch, 27.0, std::vector<double>(120, 0.9));
  const std::vector<v1::ZoneEvent> events = events_of(watch, 39.0);
  EXPECT_EQ(lines(events),
            "a entered desk 500 (1 inside)\n"
            "a dwelled desk 10500 (1 inside)\n"
            "a left desk 26000 (0 inside)\n"
            "a entered desk 27500 (1 inside)\n"
            "a dwelled desk 37500 (1 inside)\n");
  EXPECT_DOUBLE_EQ(to_seconds(from_proto(events[1].dwell())), 10.0);
}

TEST(ZoneWatch, LetsALostTargetLeaveWithItsReason) {
  ZoneWatch watch(zones(2));
  for (int i = 0; i < 10; ++i) {
    watch.see(estimate(0.1 * i, "a", {0.9, 0.8}));
  }
  watch.see(lost(6.0, "a"));
  watch.see(lost(6.5, "b"));  // never was inside
  const std::vector<v1::ZoneEvent> events = events_of(watch, 7.0);
  EXPECT_EQ(lines(events),
            "a entered desk 500 (1 inside)\na entered door 500 (1 inside)\n"
            "a left desk 6000 (0 inside)\na left door 6000 (0 inside)\n");
  EXPECT_EQ(events[2].reason(), "its track was lost");
}

TEST(ZoneWatch, LetsOneLeaveOfWhomNothingIsHeard) {
  ZoneWatch watch(zones());
  see_all(watch, 0.0, std::vector<double>(10, 0.9));
  EXPECT_EQ(lines(events_of(watch, 10.9)), "a entered desk 500 (1 inside)\n");
  const std::vector<v1::ZoneEvent> events = events_of(watch, 11.0);
  EXPECT_EQ(lines(events), "a left desk 10900 (0 inside)\n");
  EXPECT_EQ(events[0].reason(), "nothing was heard of it for 10 s");
}

TEST(ZoneWatch, NamesThoseInsideInTheOrderInWhichTheyCame) {
  ZoneWatch watch(zones());
  for (int i = 0; i < 20; ++i) {
    watch.see(estimate(0.1 * i, "b", {0.9}));
    watch.see(estimate(0.2 + 0.1 * i, "a", {0.9}));
  }
  const std::vector<v1::ZoneEvent> events = events_of(watch, 2.0);
  ASSERT_EQ(lines(events), "b entered desk 500 (1 inside)\na entered desk 700 (2 inside)\n");
  EXPECT_EQ(events[1].inside(0).mac(), "b");
  EXPECT_EQ(events[1].inside(1).mac(), "a");
}

TEST(ZoneWatch, TakesNeitherSnapshotsNorTentativeTracksNorNoFix) {
  ZoneWatch watch(zones());
  for (int i = 0; i < 20; ++i) {
    v1::Location snapshot = estimate(0.1 * i, "a", {0.9});
    snapshot.set_kind(v1::LOCATION_KIND_SNAPSHOT);
    watch.see(snapshot);
    v1::Location tentative = estimate(0.1 * i, "b", {0.9});
    tentative.set_track_state(v1::TRACK_STATE_TENTATIVE);
    watch.see(tentative);
    watch.see(estimate(0.1 * i, "c", {}));
  }
  EXPECT_EQ(lines(events_of(watch, 100.0)), "");
}

TEST(ZoneWatch, DependsNeitherOnTheOrderNorOnTheSteps) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<v1::Location> estimates;
  for (const char* mac : {"a", "b", "c"}) {
    double p = 0.5;
    for (int i = 0; i < 400; ++i) {
      p = std::clamp(p + 0.4 * (uniform(random) - 0.5), 0.0, 1.0);
      estimates.push_back(estimate(0.07 * i + (i > 200 ? 30.0 : 0.0), mac, {p, 1.0 - p}));
    }
  }
  ZoneWatch at_once(zones(2));
  for (const v1::Location& each : estimates) {
    at_once.see(each);
  }
  const std::string expected = lines(events_of(at_once, 200.0));
  EXPECT_GT(std::count(expected.begin(), expected.end(), '\n'), 20) << "seed " << kSeed;

  ZoneWatch step_by_step(zones(2));
  std::string got;
  double done = 0.0;
  for (double until = 0.31; done < 200.0; until += 0.31 + uniform(random)) {
    std::vector<v1::Location> due;
    for (const v1::Location& each : estimates) {
      const Timestamp time = from_proto(each.time());
      if (time >= at(done) && time < at(until)) {
        due.push_back(each);
      }
    }
    std::shuffle(due.begin(), due.end(), random);
    for (const v1::Location& each : due) {
      step_by_step.see(each);
    }
    got += lines(events_of(step_by_step, until));
    done = until;
  }
  EXPECT_EQ(got, expected);
}

TEST(FillZones, AddsTheHypothesesAndLeavesTheRestOutside) {
  v1::Location location;
  const auto add = [&](double x, double weight) {
    v1::Hypothesis* hypothesis = location.add_hypotheses();
    hypothesis->mutable_position()->set_x(x);
    hypothesis->mutable_position()->set_y(0.5);
    for (const double c : {0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0001}) {
      hypothesis->add_position_covariance(c);
    }
    hypothesis->set_weight(weight);
  };
  fill_zones(zones(), location);
  EXPECT_TRUE(location.zones().empty());  // no uncertainty is stated
  add(0.0, 0.6);                          // half of it inside: on the edge
  add(0.5, 0.2);                          // inside
  add(-3.0, 0.1);                         // outside; 0.1 is left over
  fill_zones(zones(2), location);
  ASSERT_EQ(location.zones_size(), 2);
  EXPECT_EQ(location.zones(0).zone(), "desk");
  EXPECT_NEAR(location.zones(0).probability(), 0.6 * 0.5 + 0.2, 1e-5);
}

}  // namespace
}  // namespace rayloc
