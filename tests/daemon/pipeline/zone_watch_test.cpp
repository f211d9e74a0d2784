#include "daemon/pipeline/zones/zone_watch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "daemon/pipeline/estimates.h"
#include "daemon/pipeline/zones/zone_estimator.h"

namespace rayloc::zone_watch_test {
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

Location estimate(double seconds, const std::string& mac, const std::vector<double>& probability) {
  Location location;
  location.estimate.time = at(seconds);
  location.target.address = mac;
  location.tracked = Tracked{TrackState::kConfirmed};
  for (const double p : probability) {
    location.zones.push_back({"", p});
  }
  return location;
}

Location lost(double seconds, const std::string& mac) {
  Location location = estimate(seconds, mac, {});
  location.tracked->state = TrackState::kLost;
  return location;
}

// "a entered 0.5 (1 inside)", one a line.
std::string lines(const std::vector<ZoneEvent>& events) {
  std::string text;
  for (const ZoneEvent& event : events) {
    text += event.target.address + " " +
            (event.kind == ZoneEventKind::kEntered ? "entered "
             : event.kind == ZoneEventKind::kLeft  ? "left "
                                                   : "dwelled ") +
            event.zone + " " + std::to_string(std::lround(to_seconds(event.time - kStart) * 1000)) +
            " (" + std::to_string(event.inside.size()) + " inside)\n";
    EXPECT_EQ(event.dwell > Duration::zero(), event.kind != ZoneEventKind::kEntered);
    EXPECT_EQ(event.reason.empty(), event.kind != ZoneEventKind::kLeft);
  }
  return text;
}

std::vector<ZoneEvent> events_of(ZoneWatch& watch, double until) {
  std::vector<ZoneEvent> events;
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
  const std::vector<ZoneEvent> left = events_of(watch, 9.0);
  EXPECT_EQ(lines(left), "a left desk 4700 (0 inside)\n");
  EXPECT_DOUBLE_EQ(to_seconds(left[0].dwell), 4.2);
  EXPECT_EQ(left[0].probability, 0.3);
  EXPECT_EQ(left[0].reason, "its probability was at most 0.3 for 1 s");
}

TEST(ZoneWatch, IgnoresATargetThatOnlyTouchesTheEdge) {
  ZoneWatch watch(zones());
  for (int i = 0; i < 20; ++i) {  // above for 0.4 s, then below, again and again
    see_all(watch, 0.6 * i, {0.9, 0.9, 0.9, 0.9, 0.9, 0.69});
  }
  EXPECT_EQ(lines(events_of(watch, 100.0)), "");
}

TEST(ZoneWatch, ReportsOneDwellForEachStay) {
  ZoneWatch watch(zones());
  see_all(watch, 0.0, std::vector<double>(250, 0.9));
  see_all(watch, 25.0, std::vector<double>(11, 0.0));
  see_all(watch, 27.0, std::vector<double>(120, 0.9));
  const std::vector<ZoneEvent> events = events_of(watch, 39.0);
  EXPECT_EQ(lines(events),
            "a entered desk 500 (1 inside)\n"
            "a dwelled desk 10500 (1 inside)\n"
            "a left desk 26000 (0 inside)\n"
            "a entered desk 27500 (1 inside)\n"
            "a dwelled desk 37500 (1 inside)\n");
  EXPECT_DOUBLE_EQ(to_seconds(events[1].dwell), 10.0);
}

TEST(ZoneWatch, LetsALostTargetLeaveWithItsReason) {
  ZoneWatch watch(zones(2));
  for (int i = 0; i < 10; ++i) {
    watch.see(estimate(0.1 * i, "a", {0.9, 0.8}));
  }
  watch.see(lost(6.0, "a"));
  watch.see(lost(6.5, "b"));  // never was inside
  const std::vector<ZoneEvent> events = events_of(watch, 7.0);
  EXPECT_EQ(lines(events),
            "a entered desk 500 (1 inside)\na entered door 500 (1 inside)\n"
            "a left desk 6000 (0 inside)\na left door 6000 (0 inside)\n");
  EXPECT_EQ(events[2].reason, "its track was lost");
}

TEST(ZoneWatch, ATargetWithoutFramesLeaves) {
  ZoneWatch watch(zones());
  see_all(watch, 0.0, std::vector<double>(10, 0.9));
  EXPECT_EQ(lines(events_of(watch, 10.9)), "a entered desk 500 (1 inside)\n");
  const std::vector<ZoneEvent> events = events_of(watch, 11.0);
  EXPECT_EQ(lines(events), "a left desk 10900 (0 inside)\n");
  EXPECT_EQ(events[0].reason, "no frame of it was received for 10 s");
}

constexpr MacAddress kPhone{{0x02, 0, 0, 0, 0, 1}};
constexpr MacAddress kLaptop{{0x02, 0, 0, 0, 0, 2}};

bool is_phone(const MacAddress& transmitter) { return transmitter == kPhone; }

// The phone enters under the name "a" at 0.5 s.
void see_phone_enter(ZoneWatch& watch) {
  for (int i = 0; i < 10; ++i) {
    watch.see(estimate(0.1 * i, "a", {0.9}), kPhone);
  }
}

TEST(ZoneWatch, ATargetWhoseBurstsWaitStays) {
  for (const double step : {1.0, 12.0}) {
    ZoneWatch watch(zones());
    std::vector<ZoneEvent> events;
    see_phone_enter(watch);
    for (double until = 1.0; until < 27.0; until += step) {
      watch.see(estimate(until - 0.05, "b", {0.1}), kLaptop);
      watch.advance(at(until), events, is_phone);
    }
    // Its burst is processed, and another target has an earlier estimate.
    watch.see(estimate(27.9, "b", {0.1}), kLaptop);
    watch.see(estimate(28.0, "a", {0.9}), kPhone);
    watch.advance(at(28.1), events);
    EXPECT_EQ(lines(events), "a entered desk 500 (1 inside)\na dwelled desk 28000 (1 inside)\n")
        << step;
    EXPECT_EQ(lines(events_of(watch, 40.0)), "a left desk 38000 (0 inside)\n") << step;
  }
}

TEST(ZoneWatch, EstimatesOfTheTimeBeforeAWaitKeepTheOrderOfEvents) {
  for (const bool is_lost : {true, false}) {
    ZoneWatch watch(zones());
    std::vector<ZoneEvent> events;
    see_phone_enter(watch);
    for (int i = 0; i < 10; ++i) {
      watch.see(estimate(8.0 + 0.1 * i, "b", {0.9}), kLaptop);
    }
    watch.advance(at(1.0), events, is_phone);
    watch.advance(at(9.0), events, is_phone);
    watch.see(estimate(5.0, "a", {0.1}), kPhone);
    watch.see(is_lost ? lost(6.5, "a") : estimate(6.5, "a", {0.1}), kPhone);
    watch.see(estimate(10.0, "a", {0.1}), kPhone);
    watch.advance(at(10.1), events);
    EXPECT_EQ(lines(events),
              "a entered desk 500 (1 inside)\nb entered desk 8500 (2 inside)\n" +
                  std::string(is_lost ? "a left desk 9000 (1 inside)\n"
                                      : "a left desk 10000 (1 inside)\n"));
  }
}

TEST(ZoneWatch, AnEarlierNameOfATransmitterThatWaitsIsSilent) {
  ZoneWatch watch(zones());
  std::vector<ZoneEvent> events;
  see_phone_enter(watch);
  watch.advance(at(4.0), events, is_phone);
  watch.see(estimate(4.5, "new", {0.9}), kPhone);
  watch.see(estimate(5.0, "new", {0.9}), kPhone);
  for (double until = 6.0; until < 30.0; until += 1.0) {
    watch.advance(at(until), events, is_phone);
  }
  EXPECT_EQ(lines(events),
            "a entered desk 500 (1 inside)\nnew entered desk 5000 (2 inside)\n"
            "a left desk 14000 (1 inside)\n");
}

// Locates a burst inside the first zone, for a second from its begin on.
class InsideEstimator : public Estimator {
 public:
  void estimate(const Burst& burst, Estimates& out) override {
    for (int i = 0; i < 10; ++i) {
      Location& location = out.locations.emplace_back();
      location.estimate.time = burst.first + i * std::chrono::milliseconds(100);
      location.estimate.position = Vec3d{0.5, 0.5, 1.2};
      location.estimate.hypotheses = {
          {{0.5, 0.5, 1.2}, {1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-4}, 1.0}};
      location.target.address = to_string(burst.transmitter);
      location.tracked = Tracked{TrackState::kConfirmed};
    }
  }
  void advance(Timestamp /*time*/, const IsWaiting& is_waiting, Estimates& /*out*/) override {
    waiting.push_back(is_waiting(kPhone));
    waiting.push_back(is_waiting(kLaptop));
  }

  std::vector<bool> waiting;  // the phone and the laptop, for each call
};

TEST(ZoneEstimator, ADeviceWhoseBurstsWaitStaysInItsZones) {
  InsideEstimator inside;
  ZoneEstimator estimator(inside, zones());
  std::array<Burst, 2> bursts;
  bursts[0].transmitter = kPhone;
  bursts[1].transmitter = kLaptop;
  bursts[0].first = bursts[1].first = kStart;
  std::array<Estimates, 2> estimates;
  estimator.estimate_each(bursts, estimates);
  Estimates out;
  for (const double seconds : {1.0, 9.0, 17.0, 25.0}) {
    estimator.advance(at(seconds), is_phone, out);
  }
  EXPECT_EQ(lines(out.zone_events),
            "02:00:00:00:00:01 entered desk 500 (1 inside)\n"
            "02:00:00:00:00:02 entered desk 500 (2 inside)\n"
            "02:00:00:00:00:02 left desk 10900 (1 inside)\n");
  EXPECT_EQ(inside.waiting, (std::vector{true, false, true, false, true, false, true, false}));
}

TEST(ZoneWatch, NamesThoseInsideInTheOrderInWhichTheyCame) {
  ZoneWatch watch(zones());
  for (int i = 0; i < 20; ++i) {
    watch.see(estimate(0.1 * i, "b", {0.9}));
    watch.see(estimate(0.2 + 0.1 * i, "a", {0.9}));
  }
  const std::vector<ZoneEvent> events = events_of(watch, 2.0);
  ASSERT_EQ(lines(events), "b entered desk 500 (1 inside)\na entered desk 700 (2 inside)\n");
  EXPECT_EQ(events[1].inside[0].address, "b");
  EXPECT_EQ(events[1].inside[1].address, "a");
}

TEST(ZoneWatch, TakesNeitherSnapshotsNorTentativeTracksNorNoFix) {
  ZoneWatch watch(zones());
  for (int i = 0; i < 20; ++i) {
    Location snapshot = estimate(0.1 * i, "a", {0.9});
    snapshot.tracked.reset();
    watch.see(snapshot);
    Location tentative = estimate(0.1 * i, "b", {0.9});
    tentative.tracked->state = TrackState::kTentative;
    watch.see(tentative);
    watch.see(estimate(0.1 * i, "c", {}));
  }
  EXPECT_EQ(lines(events_of(watch, 100.0)), "");
}

TEST(ZoneWatch, DependsNeitherOnTheOrderNorOnTheSteps) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Location> estimates;
  for (const char* mac : {"a", "b", "c"}) {
    double p = 0.5;
    for (int i = 0; i < 400; ++i) {
      p = std::clamp(p + 0.4 * (uniform(random) - 0.5), 0.0, 1.0);
      estimates.push_back(estimate(0.07 * i + (i > 200 ? 30.0 : 0.0), mac, {p, 1.0 - p}));
    }
  }
  ZoneWatch at_once(zones(2));
  for (const Location& each : estimates) {
    at_once.see(each);
  }
  const std::string expected = lines(events_of(at_once, 200.0));
  EXPECT_GT(std::count(expected.begin(), expected.end(), '\n'), 20) << "seed " << kSeed;

  ZoneWatch step_by_step(zones(2));
  std::string got;
  double done = 0.0;
  for (double until = 0.31; done < 200.0; until += 0.31 + uniform(random)) {
    std::vector<Location> due;
    for (const Location& each : estimates) {
      const Timestamp time = each.estimate.time;
      if (time >= at(done) && time < at(until)) {
        due.push_back(each);
      }
    }
    std::shuffle(due.begin(), due.end(), random);
    for (const Location& each : due) {
      step_by_step.see(each);
    }
    got += lines(events_of(step_by_step, until));
    done = until;
  }
  EXPECT_EQ(got, expected);
}

TEST(FillZones, AddsTheHypothesesAndLeavesTheRestOutside) {
  Location location;
  location.estimate.position = Vec3d{0.0, 0.5, 1.2};
  const auto add = [&](double x, double weight) {
    location.estimate.hypotheses.push_back(
        {{x, 0.5, 1.2}, {0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0001}, weight});
  };
  fill_zones(zones(), location);
  EXPECT_TRUE(location.zones.empty());  // no uncertainty is stated
  add(0.0, 0.6);                        // half of it inside: on the edge
  add(0.5, 0.2);                        // inside
  add(-3.0, 0.1);                       // outside; 0.1 is left over
  fill_zones(zones(2), location);
  ASSERT_EQ(location.zones.size(), 2U);
  EXPECT_EQ(location.zones[0].zone, "desk");
  EXPECT_NEAR(location.zones[0].probability, 0.6 * 0.5 + 0.2, 1e-5);
  location.estimate.position.reset();
  fill_zones(zones(2), location);
  EXPECT_TRUE(location.zones.empty());  // NO_FIX
}

// At any moment, a successor that receives the stays decides as its predecessor would have.
TEST(ZoneWatch, ASuccessorGoesOnWithTheStays) {
  std::mt19937 random(5);
  std::vector<Location> sightings;
  std::vector<double> probability(6, 0.5);
  for (int i = 0; i < 600; ++i) {
    const auto who = static_cast<std::size_t>(random() % 3);
    for (std::size_t zone = 0; zone < 2; ++zone) {
      double& p = probability[2 * who + zone];
      p = std::clamp(p + std::uniform_real_distribution<>(-0.2, 0.2)(random), 0.0, 1.0);
    }
    // One of them is away for long, now and then.
    if (who == 2 && i / 100 % 2 == 1) {
      continue;
    }
    const std::string name(1, static_cast<char>('a' + who));
    sightings.push_back(
        i % 97 == 0 ? lost(0.1 * i, name)
                    : estimate(0.1 * i, name, {probability[2 * who], probability[2 * who + 1]}));
  }
  ZoneWatch whole(zones(2));
  for (const Location& sighting : sightings) {
    whole.see(sighting);
  }
  const std::string expected = lines(events_of(whole, 80.0));
  EXPECT_GT(std::count(expected.begin(), expected.end(), '\n'), 20);
  for (double moment = 0.05; moment < 60.0; moment += 3.7) {
    ZoneWatch first(zones(2));
    for (const Location& sighting : sightings) {
      if (sighting.estimate.time < at(moment + 0.3)) {  // some are undecided then
        first.see(sighting);
      }
    }
    std::string output = lines(events_of(first, moment));
    ZoneWatch second(zones(2), first.stays(), at(moment));
    for (const Location& sighting : sightings) {
      if (sighting.estimate.time >= at(moment - 5.0)) {
        second.see(sighting);
      }
    }
    EXPECT_EQ(output + lines(events_of(second, 80.0)), expected) << moment;
  }
}

}  // namespace
}  // namespace rayloc::zone_watch_test
