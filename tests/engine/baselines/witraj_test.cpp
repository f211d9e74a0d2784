// Steps from a known start, and the blocks that they are made of.
#include "engine/baselines/witraj/witraj.h"

#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/baselines/motion/frame_series.h"
#include "engine/baselines/motion/path_rate.h"
#include "engine/baselines/witraj/plan_step.h"
#include "tests/support/synthetic_room.h"
#include "tests/support/walking_echo.h"

namespace rayloc::witraj_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kStep = 0.0025;         // [s], 400 frames/s
constexpr double kWavelength = 0.05776;  // [m]
constexpr double kTwoPi = 2.0 * std::numbers::pi;
const MacAddress kPlug = *parse_mac_address("02:00:00:00:00:09");

// A circle about `centre`, whose path gets longer at `rate` [m/s].
std::vector<std::complex<double>> circle(std::complex<double> centre, double rate) {
  std::vector<std::complex<double>> q;
  q.reserve(400);
  for (int i = 0; i < 400; ++i) {
    q.push_back(centre + std::polar(0.2, -kTwoPi * rate * kStep * i / kWavelength));
  }
  return q;
}

TEST(PathRate, IsThatOfAPureCircleInBothSenses) {
  for (const double rate : {1.0, -1.0, 0.3, -2.0}) {
    for (const PathRateOptions& options : {PathRateOptions{0.0275, 0.15}, {0.0425, 0.24}}) {
      const auto rates = path_rates(circle({0.9, 0.4}, rate), kStep, kWavelength, options);
      for (std::size_t i = 80; i < 320; ++i) {
        EXPECT_NEAR(rates[i].rate, rate, 0.01 * std::abs(rate)) << i;
      }
    }
  }
}

TEST(PathRate, ScoresAnEvenRotationHigher) {
  auto noisy = circle({0.9, 0.4}, 1.0);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 0.05);
  for (auto& value : noisy) {
    const double real = normal(random);
    value += std::complex<double>(real, normal(random));
  }
  const auto even = path_rates(circle({0.9, 0.4}, 1.0), kStep, kWavelength);
  const auto uneven = path_rates(noisy, kStep, kWavelength);
  EXPECT_GT(even[200].score, 10.0 * uneven[200].score);
  EXPECT_NEAR(uneven[200].rate, 1.0, 0.2);
}

Timestamp at(double seconds) { return Timestamp(from_seconds(seconds)); }

TEST(FrameSeries, InterpolatesAndEndsAtAGap) {
  FrameSeries series;
  for (int i = 0; i < 100; ++i) {
    if (i % 20 != 7) {  // lost
      EXPECT_TRUE(series.add(at(kStep * i), {std::complex<double>(i, -i)}));
    }
  }
  EXPECT_NEAR(series.rate(), 400.0, 1e-6);
  EXPECT_NEAR((*series.at(at(kStep * 7.0)))[0].real(), 7.0, 1e-6);
  EXPECT_NEAR((*series.at(at(kStep * 50.25)))[0].imag(), -50.25, 1e-6);
  EXPECT_FALSE(series.at(at(-1.0)));
  EXPECT_FALSE(series.at(at(1.0)));
  EXPECT_TRUE(series.add(at(kStep * 103.0), {1.0})) << "three lost frames are bridged";
  EXPECT_FALSE(series.add(at(kStep * 108.0), {1.0})) << "four are a gap";
  EXPECT_EQ(series.first(), at(kStep * 108.0));
}

// Rates by the difference of true lengths along a walk of 10 m past the line of sight.
TEST(PlanStep, FollowsTrueRates) {
  const Vec3d transmitter{1.2, -0.4, 0.0};
  const std::vector<Vec3d> receivers = {{-1.4, 1.0, 0.0}, {1.45, 1.0, 0.0}, {-0.2, -1.2, 0.0}};
  const auto place = [](double s) {
    return Vec3d{0.9 * std::cos(1.1 * s), 0.6 * std::sin(1.7 * s + 0.4), 0.0};
  };
  const auto length = [&](const Vec3d& receiver, double s) {
    return norm(place(s) - transmitter) + norm(place(s) - receiver);
  };
  constexpr double kSeconds = 0.025;
  double walked = 0.0;
  double s = 0.0;
  Vec3d here = place(0.0);
  while (walked < 10.0) {
    std::vector<PathRateAt> rates;
    rates.reserve(receivers.size());
    for (const Vec3d& receiver : receivers) {
      rates.push_back(
          {receiver, (length(receiver, s + kSeconds) - length(receiver, s)) / kSeconds});
    }
    const PlanStep step = plan_step(transmitter, rates, here, kSeconds);
    here = here + Vec3d{step.x, step.y, 0.0};
    walked += norm(place(s + kSeconds) - place(s));
    s += kSeconds;
    EXPECT_LT(norm(here - place(s)), 0.03) << s;
  }
}

TEST(PlanStep, DoesNotRunOffOnTheLineOfSight) {
  const std::vector<PathRateAt> rates = {{{-1.0, 0.0, 0.0}, 1.0}, {{-1.5, 0.0, 0.0}, 1.0}};
  const PlanStep step = plan_step({1.0, 0.0, 0.0}, rates, {0.0, 0.0, 0.0}, 0.025);
  EXPECT_LT(std::hypot(step.x, step.y), 0.1);
}

std::shared_ptr<const RoomModel> room() {
  static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
  return kRoom;
}

const WitrajLink kLink = {kPlug, {1.0, -0.6, 1.2}, {0, 1, 2}};

// How strong the direct path is at an antenna on a tone.
using Share = std::function<double(std::size_t, std::size_t)>;

// A fade on one side, so that the antennas differ as they do in rooms.
double fade_on_one_side(std::size_t antenna, std::size_t /*tone*/) {
  return 1.0 + 0.6 * static_cast<double>(antenna);
}

std::vector<CsiFrame> walk(double seconds,
                           double step,
                           const std::function<Vec3d(double)>& place,
                           const Share& share = fade_on_one_side) {
  return test::frames_past(
      *room(), {kPlug, kLink.position, 0.3, 40.0, share}, seconds, step, place);
}

std::vector<LocationEstimate> received(Witraj& witraj, const std::vector<CsiFrame>& frames) {
  std::vector<LocationEstimate> out;
  for (std::size_t i = 0; i < frames.size(); i += 240) {  // bursts of 0.2 s
    witraj.receive(std::span(frames).subspan(i, std::min<std::size_t>(240, frames.size() - i)),
                   out);
  }
  return out;
}

Vec3d route(double t) { return {-0.6 + 0.4 * t, 0.3 * std::sin(1.2 * t), 1.2}; }

// [m], against route().
double worst_error(const std::vector<LocationEstimate>& estimates) {
  double worst = 0.0;
  for (const LocationEstimate& estimate : estimates) {
    const Vec3d truth = route(to_seconds(estimate.time.time_since_epoch()));
    worst =
        std::max(worst, std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y));
  }
  return worst;
}

TEST(Witraj, FollowsAWalkFromItsStart) {
  auto witraj = *Witraj::create(room(), kLink, route(0.0), {});
  const auto estimates = received(witraj, walk(3.0, kStep, route));
  ASSERT_GT(estimates.size(), 90U);
  EXPECT_LT(worst_error(estimates), 0.12) << "of a walk of 1.4 m";
  EXPECT_GT(estimates.back().accuracy_m, estimates.front().accuracy_m) << "the error grows";
  EXPECT_EQ(witraj.problem(), "");
}

// On four tones of ten the other antenna fades: there the published rule has the pole inside of the
// circle.
TEST(Witraj, SelectsTheWeakerAntennaPerToneOnRequest) {
  const auto fades = [](std::size_t antenna, std::size_t tone) {
    const bool is_first = tone % 10 < 4;
    return antenna == (is_first ? 0U : 2U) ? 0.15 : 2.0;
  };
  const auto frames = walk(3.0, kStep, route, fades);
  auto published = *Witraj::create(room(), kLink, route(0.0), {});
  auto by_tone = *Witraj::create(room(), kLink, route(0.0), {.by_tone = true});
  const double worst = worst_error(received(by_tone, frames));
  EXPECT_LT(worst, 0.15);
  EXPECT_GT(worst_error(received(published, frames)), 2.0 * worst);
}

TEST(Witraj, HoldsThePositionOfAMotionlessPerson) {
  const Vec3d start{0.1, 0.2, 1.2};
  auto witraj = *Witraj::create(room(), kLink, start, {});
  const auto estimates = received(witraj, walk(2.0, kStep, [&](double) { return start; }));
  ASSERT_FALSE(estimates.empty());
  EXPECT_NEAR(estimates.back().position->x, start.x, 0.25);
  EXPECT_NEAR(estimates.back().position->y, start.y, 0.25);
  EXPECT_THAT(estimates.back().warnings, Contains("nothing moves: the place is held"));
}

TEST(Witraj, RefusesInvalidInputsWithAMessage) {
  const auto without = Witraj::create(room(), kLink, std::nullopt, {});
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().kind, ErrorKind::kUsage);
  EXPECT_EQ(without.error().message,
            "--method witraj adds steps to a known start: give --start X,Y");
  const auto one = Witraj::create(room(), {kPlug, kLink.position, {0}}, Vec3d{}, {});
  ASSERT_FALSE(one);
  EXPECT_EQ(one.error().message,
            "witraj needs 2 access points that receive one transmitter, 3 to drop the worst; the "
            "site has a");
  RoomModel odd = test::make_room();
  odd.grid.tone_index = {1, 2, 3, 5, 8};
  const auto no_comb = Witraj::create(std::make_shared<const RoomModel>(odd), kLink, Vec3d{}, {});
  ASSERT_FALSE(no_comb);
  EXPECT_THAT(no_comb.error().message, HasSubstr("witraj needs tones in equal steps"));
  auto slow = *Witraj::create(room(), kLink, Vec3d{}, {});
  EXPECT_TRUE(received(slow,
                       walk(1.5,
                            0.02,
                            [](double t) {
                              return Vec3d{0.3 * t, 0.0, 1.2};
                            }))
                  .empty());
  EXPECT_THAT(slow.problem(),
              HasSubstr("50 frames/s of 02:00:00:00:00:09 at a: witraj needs 182 (5 frames in a "
                        "window of 27.5 ms); send more often"));
}

}  // namespace
}  // namespace rayloc::witraj_test
