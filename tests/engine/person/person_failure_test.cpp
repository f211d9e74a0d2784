// Faults of the links that locate a person: at most one case in twenty may state a 95 % region that
// excludes the truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/person/person_localizer.h"
#include "tests/support/person_in_room.h"

namespace rayloc::person_failure_test {
namespace {

using Channels = std::vector<std::vector<std::complex<double>>>;

constexpr std::size_t kCases = 24;

// Places of the synthetic room at least 0.25 m from walls and devices.
TargetPosition place(std::size_t i) {
  const auto column = static_cast<double>(i % 6);
  const auto row = static_cast<double>(i / 6 % 4);
  return {-1.0 + 0.38 * column + 0.03 * row, -0.55 + 0.41 * row + 0.02 * column};
}

struct Outcome {
  std::size_t fixes = 0;
  std::size_t warned = 0;  // with or without a fix
  std::size_t misses = 0;  // fixes whose region excludes every person
  double accuracy = 0.0;   // [m], mean of what was stated
};

class PersonFailureTest : public ::testing::TestWithParam<std::size_t> {
 protected:
  static void SetUpTestSuite() {
    for (const std::size_t count : {std::size_t{1}, std::size_t{3}}) {
      RoomModel room = test::make_room();
      room.access_points.resize(count);
      const auto shared = std::make_shared<const RoomModel>(std::move(room));
      localizers()[count] = std::make_shared<const PersonLocalizer>(
          *PersonLocalizer::create(shared, test::learn_reference(*shared), {}));
    }
  }
  static void TearDownTestSuite() { localizers().clear(); }

  const PersonLocalizer& localizer() const { return *localizers().at(GetParam()); }

  // `people`: number of people in the room; `spoil` changes the channels of the access points.
  template <typename Spoil>
  Outcome run(const char* name, std::size_t people, const Spoil& spoil) const {
    Outcome outcome;
    for (std::size_t i = 0; i < kCases; ++i) {
      std::vector<TargetPosition> truth;
      for (std::size_t p = 0; p < people; ++p) {
        truth.push_back(place(i + 11 * p));
      }
      Channels channels = test::channels_past(localizer().room(), truth, PersonModel{}.body);
      spoil(i, channels);
      const auto estimate = localizer().locate(test::frames_of(
          localizer().room(), channels, {.count = 8, .seed = static_cast<unsigned>(i + 1)}));
      count(estimate, truth, outcome);
    }
    std::printf(
        "%s, %zu access points, n = %zu: %zu fixes, %zu warned, %zu misses, %.2f m stated\n",
        name,
        GetParam(),
        kCases,
        outcome.fixes,
        outcome.warned,
        outcome.misses,
        outcome.accuracy / static_cast<double>(std::max<std::size_t>(outcome.fixes, 1)));
    return outcome;
  }

 private:
  static void count(const LocationEstimate& estimate,
                    const std::vector<TargetPosition>& truth,
                    Outcome& outcome) {
    outcome.warned += estimate.warnings.empty() ? 0U : 1U;
    if (!estimate.position) {
      EXPECT_FALSE(estimate.reason.empty());
      return;
    }
    ++outcome.fixes;
    outcome.accuracy += estimate.accuracy_m;
    bool holds = false;
    for (const TargetPosition& one : truth) {
      holds = holds || std::hypot(estimate.position->x - one.x, estimate.position->y - one.y) <=
                           estimate.accuracy_m;
    }
    outcome.misses += holds ? 0U : 1U;
  }

  // Made once for all cases, by number of access points.
  static std::map<std::size_t, std::shared_ptr<const PersonLocalizer>>& localizers() {
    static std::map<std::size_t, std::shared_ptr<const PersonLocalizer>> made;
    return made;
  }
};

TEST_P(PersonFailureTest, NoFault) {
  const Outcome outcome = run("nothing wrong", 1, [](std::size_t, Channels&) {});
  EXPECT_LE(outcome.misses, 1U);
  EXPECT_GE(outcome.fixes, 20U);
}

TEST_P(PersonFailureTest, TwoPeopleWhereOneIsExpected) {
  EXPECT_LE(run("two people", 2, [](std::size_t, Channels&) {}).misses, 1U);
}

TEST_P(PersonFailureTest, AChainIsDead) {
  const auto spoil = [this](std::size_t i, Channels& channels) {
    auto& h = channels[i % channels.size()];
    const std::size_t tones = localizer().room().grid.size();
    const std::size_t rx_chain = i % 3;
    // The channel of a dead chain has a hundredth of the others' amplitude.
    std::for_each(h.begin() + static_cast<std::ptrdiff_t>(rx_chain * tones),
                  h.begin() + static_cast<std::ptrdiff_t>((rx_chain + 1) * tones),
                  [](std::complex<double>& value) { value *= 0.01; });
  };
  EXPECT_LE(run("a chain dead", 1, spoil).misses, 1U);
}

TEST_P(PersonFailureTest, AChainsPhaseHasJumped) {
  const auto spoil = [this](std::size_t i, Channels& channels) {
    auto& h = channels[i % channels.size()];
    const std::size_t tones = localizer().room().grid.size();
    const std::size_t rx_chain = i % 3;
    const double jump = std::numbers::pi * (i % 2 == 0 ? 0.5 : 1.0);
    std::for_each(h.begin() + static_cast<std::ptrdiff_t>(rx_chain * tones),
                  h.begin() + static_cast<std::ptrdiff_t>((rx_chain + 1) * tones),
                  [&](std::complex<double>& value) { value *= std::polar(1.0, jump); });
  };
  EXPECT_LE(run("a chain's phase jumped", 1, spoil).misses, 1U);
}

TEST_P(PersonFailureTest, TheTransmitterWasMoved) {
  const auto spoil = [this](std::size_t i, Channels& channels) {
    const RoomModel& room = localizer().room();
    const Vec3d here = test::fixed_transmitter().position;
    const Vec3d shift{-0.1 - 0.02 * static_cast<double>(i % 5), 0.08, -0.1};
    for (std::size_t a = 0; a < channels.size(); ++a) {
      const auto before = test::channel_at(room, room.access_points[a], here);
      const auto after = test::channel_at(room, room.access_points[a], here + shift);
      for (std::size_t j = 0; j < channels[a].size(); ++j) {
        channels[a][j] += after[j] - before[j];  // the person's part stays
      }
    }
  };
  EXPECT_LE(run("transmitter moved", 1, spoil).misses, 1U);
}

TEST_P(PersonFailureTest, TheTransmitterIsObstructed) {
  // Most of its line of sight is gone: a box is before it, and reflections by walls are left.
  const auto spoil = [this](std::size_t i, Channels& channels) {
    const RoomModel& room = localizer().room();
    for (std::size_t a = 0; a < channels.size(); ++a) {
      const auto direct = test::direct_channel(room, room.access_points[a]);
      for (std::size_t j = 0; j < channels[a].size(); ++j) {
        channels[a][j] -= (0.8 + 0.008 * static_cast<double>(i)) * direct[j];
      }
    }
  };
  EXPECT_LE(run("transmitter covered", 1, spoil).misses, 1U);
}

TEST_P(PersonFailureTest, AnotherTransmitterWithTheSameAddress) {
  const auto spoil = [this](std::size_t i, Channels& channels) {
    const RoomModel& room = localizer().room();
    for (std::size_t a = 0; a < channels.size(); ++a) {
      const TargetPosition other = place(i);
      channels[a] = test::channel_at(room, room.access_points[a], {other.x, other.y, 0.9});
    }
  };
  // No person affects these channels: any position is wrong, so it must be wide or refused.
  const Outcome outcome = run("another transmitter", 1, spoil);
  EXPECT_LE(outcome.misses, 1U);
}

TEST_P(PersonFailureTest, TheTransmitterIsAbsent) {
  EXPECT_EQ(localizer().locate({}).reason, "no frames");
}

INSTANTIATE_TEST_SUITE_P(AccessPoints, PersonFailureTest, ::testing::Values(1U, 3U));

}  // namespace
}  // namespace rayloc::person_failure_test
