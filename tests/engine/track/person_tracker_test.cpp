#include "engine/track/person_tracker.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/person_in_room.h"

namespace rayloc::person_tracker_test {
namespace {

// Three frames of each access point from this time on.
std::vector<CsiFrame> moment(const RoomModel& room,
                             const std::vector<TargetPosition>& places,
                             double seconds) {
  auto frames = test::frames_past(room,
                                  places,
                                  PersonModel{}.body,
                                  {.count = 3, .seed = static_cast<unsigned>(1000.0 * seconds)});
  for (CsiFrame& frame : frames) {
    frame.time += from_seconds(seconds);
  }
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  return frames;
}

// The phases of each access point's chains, off by draws of this deviation [rad].
void jitter(std::vector<CsiFrame>& frames, double sigma, unsigned seed) {
  for (CsiFrame& frame : frames) {
    std::mt19937 random(seed * 16 + static_cast<unsigned>(frame.access_point));
    std::normal_distribution<double> draw(0.0, sigma);
    for (std::size_t chain = 0; chain < frame.rx_chains.size(); ++chain) {
      const std::complex<float> factor(std::polar(1.0, draw(random)));
      for (std::complex<float>& value : frame.csi.row(chain, 0)) {
        value *= factor;
      }
    }
  }
}

double width(const std::vector<PersonUpdate>& updates) {
  const auto& covariance = updates.back().estimate.location.covariance;
  return covariance[0] + covariance[4];
}

class PersonTracking : public ::testing::Test {
 protected:
  using Updates = std::vector<PersonUpdate>;

  static const std::shared_ptr<const RoomModel>& room() {
    static const auto kMade = std::make_shared<const RoomModel>(test::make_room());
    return kMade;
  }
  static const std::shared_ptr<const PersonLocalizer>& localizer() {
    static const auto kMade = std::make_shared<const PersonLocalizer>(
        *PersonLocalizer::create(room(), test::learn_reference(*room()), {}));
    return kMade;
  }
  static const std::vector<CsiFrame>& stationary() {
    static const std::vector<CsiFrame> kMade = moment(*room(), {{0.2, 0.2}}, 0.0);
    return kMade;
  }

  // A person is in the room, at this time.
  static std::vector<CsiFrame> with_person(double seconds) {
    std::vector<CsiFrame> frames = stationary();
    for (CsiFrame& frame : frames) {
      frame.time += from_seconds(seconds);
    }
    return frames;
  }
  // The tracker receives `count` moments with a person, every 0.1 s from this time on.
  static void see(PersonTracker& tracker, double begin, int count, Updates& updates) {
    for (int i = 0; i < count; ++i) {
      tracker.receive(with_person(begin + 0.1 * i), updates);
    }
  }
  static Timestamp at(double seconds) { return stationary().front().time + from_seconds(seconds); }
  static PersonTracker tracker(const PersonTrackerOptions& options = {}) {
    return {localizer(), options};
  }
  static std::vector<TrackState> entered(const Updates& updates) {
    std::vector<TrackState> states;
    for (const PersonUpdate& update : updates) {
      if (update.estimate.transition) {
        states.push_back(update.estimate.transition->after);
      }
    }
    return states;
  }
  static void expect_same(const Updates& a, const Updates& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].track, b[i].track);
      EXPECT_EQ(a[i].estimate.state, b[i].estimate.state);
      EXPECT_EQ(a[i].estimate.location.time, b[i].estimate.location.time);
      ASSERT_TRUE(a[i].estimate.location.position && b[i].estimate.location.position);
      EXPECT_EQ(a[i].estimate.location.position->x, b[i].estimate.location.position->x);
      EXPECT_EQ(a[i].estimate.location.covariance, b[i].estimate.location.covariance);
    }
  }
};

using enum TrackState;

TEST_F(PersonTracking, FollowsAWalkAndLosesADepartedPerson) {
  auto tracker = PersonTracking::tracker();
  Updates updates;

  // No person yet.
  for (int i = 0; i < 5; ++i) {
    tracker.receive(moment(*room(), {}, 0.1 * i), updates);
  }
  EXPECT_TRUE(updates.empty());

  int near = 0;
  for (int i = 0; i < 40; ++i) {
    const double t = 1.0 + 0.1 * i;
    const TargetPosition truth{-0.8 + 0.04 * i, 0.3 - 0.01 * i};
    updates.clear();
    tracker.receive(moment(*room(), {truth}, t), updates);
    ASSERT_EQ(updates.size(), 1U);
    EXPECT_EQ(updates[0].track, 1U);
    const auto& location = updates[0].estimate.location;
    if (i >= 10 && location.position) {
      near +=
          std::hypot(location.position->x - truth.x, location.position->y - truth.y) < 0.1 ? 1 : 0;
    }
  }
  EXPECT_GE(near, 28);
  EXPECT_EQ(updates[0].estimate.state, kConfirmed);

  updates.clear();
  for (int i = 0; i < 60; ++i) {
    tracker.receive(moment(*room(), {}, 5.0 + 0.1 * i), updates);
  }
  EXPECT_EQ(entered(updates), (std::vector{kCoasting, kLost}));
  EXPECT_EQ(updates.back().estimate.state, kLost);
  EXPECT_FALSE(std::any_of(updates.begin(), updates.end(), [](const PersonUpdate& update) {
    return !update.estimate.predicted;
  }));

  // The next person is another track.
  updates.clear();
  for (int i = 0; i < 5; ++i) {
    tracker.receive(moment(*room(), {{0.2, 0.2}}, 20.0 + 0.1 * i), updates);
  }
  ASSERT_FALSE(updates.empty());
  EXPECT_EQ(updates.back().track, 2U);

  const PersonTrackerCounters& counters = tracker.counters();
  EXPECT_EQ(counters.begun, 2U);
  EXPECT_EQ(counters.lost, 1U);
  EXPECT_EQ(counters.moments, 110U);
  EXPECT_EQ(counters.used, 45U);
  EXPECT_EQ(counters.no_person, 65U);
  EXPECT_EQ(counters.moments,
            counters.used + counters.no_person + counters.unexplained + counters.out_of_order +
                counters.unusable);
}

// The place that the whole room ranks first is among those of a tracker that evaluates likely cells
// only, and both use the same moments.
TEST_F(PersonTracking, LimitedSearchMatchesTheWholeRoom) {
  constexpr double kSamePlace = 0.15;  // [m]
  auto quick = PersonTracking::tracker();
  auto exhaustive = PersonTracking::tracker({.is_exhaustive = true});
  for (int i = 0; i < 40; ++i) {
    const auto frames = moment(*room(), {{-0.8 + 0.04 * i, 0.3 - 0.01 * i}}, 0.1 * i);
    Updates found;
    Updates expected;
    quick.receive(frames, found);
    exhaustive.receive(frames, expected);
    ASSERT_EQ(found.size(), 1U);
    ASSERT_EQ(expected.size(), 1U);
    EXPECT_EQ(found[0].estimate.state, expected[0].estimate.state) << i;
    ASSERT_FALSE(expected[0].estimate.location.hypotheses.empty());
    const Vec3d best = expected[0].estimate.location.hypotheses.front().position;
    const auto& named = found[0].estimate.location.hypotheses;
    EXPECT_TRUE(std::any_of(named.begin(), named.end(), [&](const Hypothesis& one) {
      return std::hypot(one.position.x - best.x, one.position.y - best.y) < kSamePlace;
    })) << i;
  }
  EXPECT_EQ(quick.counters().used, exhaustive.counters().used);
}

// However little the moments indicate, a person whose evidence is not clear any more is lost.
TEST_F(PersonTracking, LosesAPersonAfterUnclearEvidence) {
  PersonTrackerOptions options;
  options.lose_after = std::chrono::seconds(100);
  options.unclear_after = std::chrono::seconds(2);
  auto tracker = PersonTracking::tracker(options);
  Updates updates;
  see(tracker, 0.0, 40, updates);  // clearly, and for longer than that
  EXPECT_EQ(entered(updates), (std::vector{kTentative, kConfirmed}));
  for (int i = 0; i < 40; ++i) {
    tracker.receive(moment(*room(), {}, 4.0 + 0.1 * i), updates);
  }
  ASSERT_EQ(entered(updates), (std::vector{kTentative, kConfirmed, kCoasting, kLost}));
  EXPECT_EQ(updates.back().estimate.transition->reason, "not clearly seen for too long");
  EXPECT_LT(std::abs(to_seconds(updates.back().estimate.location.time - at(3.9 + 2.0))), 0.15);
}

TEST_F(PersonTracking, CoastsAtFixedTimesHoweverOftenItIsAsked) {
  auto at_once = tracker();
  Updates once;
  see(at_once, 0.0, 6, once);
  const std::size_t seen = once.size();
  const Timestamp last = once.back().estimate.location.time;
  at_once.advance(last + std::chrono::seconds(60), once);

  EXPECT_EQ(entered(once), (std::vector{kTentative, kConfirmed, kCoasting, kLost}));
  // 0.5, 0.7 ... 5.1 s after it was seen: the first of these that is 5 s or more is the last.
  ASSERT_EQ(once.size(), seen + 24);
  for (std::size_t i = seen; i < once.size(); ++i) {
    const FilteredEstimate& estimate = once[i].estimate;
    EXPECT_EQ(estimate.location.time, last + std::chrono::milliseconds(500 + 200 * (i - seen)));
    EXPECT_EQ(estimate.location.capture_end, last);
    EXPECT_TRUE(estimate.predicted);
    EXPECT_EQ(estimate.state, i + 1 < once.size() ? kCoasting : kLost);
  }
  EXPECT_EQ(once.back().estimate.transition->reason, "not seen for too long");

  auto often = tracker();
  Updates stepwise;
  see(often, 0.0, 6, stepwise);
  for (int i = 0; i < 700; ++i) {
    often.advance(last + std::chrono::milliseconds(10 * i), stepwise);
  }
  expect_same(once, stepwise);

  // Without any advance until a person is seen again: the same, and a new track.
  auto never = tracker();
  Updates silent;
  see(never, 0.0, 6, silent);
  see(never, 30.0, 1, silent);
  ASSERT_EQ(silent.size(), once.size() + 1);
  EXPECT_EQ(silent.back().track, 2U);
  EXPECT_EQ(silent.back().estimate.state, kTentative);
  silent.pop_back();
  expect_same(once, silent);
}

TEST_F(PersonTracking, ConfirmsACoastingPersonAgain) {
  auto tracker = PersonTracking::tracker();
  Updates updates;
  see(tracker, 0.0, 6, updates);
  see(tracker, 3.0, 1, updates);
  EXPECT_EQ(entered(updates), (std::vector{kTentative, kConfirmed, kCoasting, kConfirmed}));
  EXPECT_EQ(updates.back().track, 1U);
  EXPECT_FALSE(updates.back().estimate.predicted);
  EXPECT_EQ(tracker.counters().lost, 0U);
}

TEST_F(PersonTracking, ForgetsABrieflySeenPersonSoon) {
  auto tracker = PersonTracking::tracker();
  Updates updates;
  see(tracker, 0.0, 2, updates);
  const Timestamp last = updates.back().estimate.location.time;
  tracker.advance(last + std::chrono::milliseconds(1100), updates);
  EXPECT_EQ(entered(updates), std::vector{kTentative});
  tracker.advance(last + std::chrono::milliseconds(1101), updates);
  EXPECT_EQ(entered(updates), (std::vector{kTentative, kLost}));
  EXPECT_EQ(updates.back().estimate.location.time, last + std::chrono::milliseconds(1100));
}

TEST_F(PersonTracking, IsNotSilentWhereBurstsWereLeftOut) {
  auto tracker = PersonTracking::tracker();
  Updates updates;
  see(tracker, 0.0, 6, updates);
  tracker.receive(with_person(4.0), updates, at(0.6));
  EXPECT_EQ(entered(updates), (std::vector{kTentative, kConfirmed}));
}

TEST_F(PersonTracking, RefusesMomentsThatComeTooLate) {
  auto tracker = PersonTracking::tracker();
  Updates updates;
  see(tracker, 0.0, 6, updates);
  tracker.advance(at(2.0), updates);
  const std::size_t before = updates.size();
  see(tracker, 1.0, 1, updates);
  EXPECT_EQ(updates.size(), before);
  EXPECT_GT(tracker.counters().out_of_order, 0U);
  EXPECT_EQ(tracker.counters().used, 6U);
}

TEST_F(PersonTracking, EndsWhenTimeMayGoBack) {
  auto tracker = PersonTracking::tracker();
  Updates updates;
  see(tracker, 100.0, 6, updates);
  tracker.restart("moved", updates);
  EXPECT_EQ(entered(updates), (std::vector{kTentative, kConfirmed, kLost}));
  EXPECT_EQ(updates.back().estimate.transition->reason, "moved");
  const std::size_t before = updates.size();
  tracker.restart("moved", updates);
  tracker.advance(at(1000.0), updates);
  EXPECT_EQ(updates.size(), before);
  see(tracker, 0.0, 1, updates);
  EXPECT_EQ(updates.back().track, 2U);
  EXPECT_EQ(tracker.counters().begun, 2U);
  EXPECT_EQ(tracker.counters().lost, 1U);
}

TEST_F(PersonTracking, NumbersTracksAsConfigured) {
  auto tracker = PersonTracking::tracker({.first_number = 2, .number_step = 3});
  Updates updates;
  see(tracker, 0.0, 1, updates);
  EXPECT_EQ(updates.back().track, 2U);
  see(tracker, 10.0, 1, updates);
  EXPECT_EQ(updates.back().track, 5U);
}

// Chains that jitter are no new evidence, so the region of a standing person does not shrink.
TEST_F(PersonTracking, CountsARestOnce) {
  constexpr double kJitter = 0.026;  // [rad], 1.5 degrees
  PersonReference reference = test::learn_reference(*room());
  reference.person.likelihood_exponent = 0.1;
  PersonTracker tracker(std::make_shared<const PersonLocalizer>(
                            *PersonLocalizer::create(room(), std::move(reference), {})),
                        {});
  Updates updates;
  double after_a_second = 0.0;
  for (unsigned i = 0; i < 50; ++i) {
    auto frames = with_person(0.1 * i);
    jitter(frames, kJitter, i);
    tracker.receive(frames, updates);
    if (i == 12) {
      after_a_second = width(updates);
    }
  }
  EXPECT_EQ(updates.back().estimate.state, kConfirmed);
  EXPECT_GT(width(updates), 0.7 * after_a_second);
}

// Each step is hidden by the jitter that a rest has, and the steps add up.
TEST_F(PersonTracking, FollowsASlowMovement) {
  auto tracker = PersonTracking::tracker();
  Updates updates;
  for (int i = 0; i <= 40; ++i) {
    tracker.receive(moment(*room(), {{0.2 - 0.005 * i, 0.2}}, 0.1 * i), updates);
  }
  const auto& position = updates.back().estimate.location.position;
  ASSERT_TRUE(position);
  EXPECT_LT(std::hypot(position->x, position->y - 0.2), 0.1);
}

// The error of a body that is not round stays while one access point sees one side of it.
TEST_F(PersonTracking, WidensRegionsAfterOneSidedEvidence) {
  PersonReference reference = test::learn_reference(*room());
  reference.person.front_offset_sigma = 0.03;
  const auto uneven = std::make_shared<const PersonLocalizer>(
      *PersonLocalizer::create(room(), std::move(reference), {}));
  const auto walk = [&](Duration one_sided, bool is_one) {
    PersonTracker tracker(uneven, {.one_sided_evidence_time = one_sided});
    Updates updates;
    for (int i = 0; i < 8; ++i) {
      auto frames = moment(*room(), {{-0.6 + 0.09 * i, 0.3}}, 0.1 * i);
      frames.erase(
          std::remove_if(frames.begin(),
                         frames.end(),
                         [&](const CsiFrame& frame) { return is_one && frame.access_point != 0; }),
          frames.end());
      tracker.receive(frames, updates);
    }
    return updates;
  };
  using std::chrono::milliseconds;
  expect_same(walk(milliseconds(250), false), walk(milliseconds(2000), false));
  const auto brief = walk(milliseconds(250), true);
  const auto lasting = walk(milliseconds(2000), true);
  ASSERT_FALSE(brief.empty());
  ASSERT_EQ(brief.size(), lasting.size());
  EXPECT_GT(width(lasting), width(brief));
}

}  // namespace
}  // namespace rayloc::person_tracker_test
