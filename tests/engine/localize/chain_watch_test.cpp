#include "engine/monitor/chain_watch.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <numbers>
#include <random>

#include "tests/support/faulty_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc {
namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;

// The synthetic room, heard by its first access point, which models it well.
std::shared_ptr<const Localizer> localizer() {
  static const std::shared_ptr<const Localizer> kLocalizer = [] {
    RoomModel room = test::make_room();
    room.access_points.resize(1);
    room.access_points[0].error.plan_tolerance = 0.001;
    room.access_points[0].error.diffuse = 0.005;
    auto made = Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
    return std::make_shared<const Localizer>(*std::move(made));
  }();
  return kLocalizer;
}

// A device somewhere else every two seconds.
std::vector<CsiFrame> burst(int number) {
  std::mt19937 random(static_cast<unsigned>(number + 1));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double x = 1.2 * uniform(random);
  auto frames = test::frames_at(localizer()->room(),
                                {x, 0.9 * uniform(random), 1.2},
                                {4, 30.0, static_cast<unsigned>(number + 1)});
  for (CsiFrame& frame : frames) {
    frame.time += std::chrono::seconds(2 * number);
  }
  return frames;
}

std::uint8_t core(std::size_t row) { return localizer()->room().access_points[0].cores[row]; }

TEST(ChainWatch, SaysNothingOfChainsThatAreAsCalibrated) {
  ChainWatch watch(localizer());
  for (int i = 0; i < 20; ++i) {
    watch.hear(burst(i));
    EXPECT_TRUE(watch.turned().empty()) << i;
  }
}

TEST(ChainWatch, NamesTheChainThatHasTurnedAndByHowMuch) {
  for (const int quarters : {1, 2, 3}) {
    ChainWatch watch(localizer());
    for (int i = 0; i < 12; ++i) {
      auto frames = burst(i);
      test::turn_chain(frames, 0, core(2), kQuarter * quarters);
      watch.hear(frames);
    }
    const auto turned = watch.turned();
    ASSERT_EQ(turned.size(), 1U) << quarters;
    EXPECT_EQ(turned[0].access_point, 0U);
    EXPECT_GT(turned[0].probability, ChainWatch::kSure);
    ASSERT_EQ(turned[0].phase.size(), 3U);
    EXPECT_EQ(turned[0].phase[0], 0.0);
    EXPECT_EQ(turned[0].phase[1], 0.0);
    EXPECT_NEAR(
        std::remainder(turned[0].phase[2] - kQuarter * quarters, 4.0 * kQuarter), 0.0, 1e-9);
  }
}

// A turn in the midst of it, and back again.
TEST(ChainWatch, FollowsWhatChanges) {
  ChainWatch watch(localizer());
  for (int i = 0; i < 60; ++i) {
    auto frames = burst(i);
    if (i >= 20 && i < 40) {
      test::turn_chain(frames, 0, core(1), kQuarter);
    }
    watch.hear(frames);
    if (i == 39 || i == 59) {
      EXPECT_EQ(watch.turned().empty(), i == 59) << i;
    }
  }
  watch.restart();
  EXPECT_TRUE(watch.turned().empty());
}

TEST(ChainWatch, OfSeveralAccessPointsTheOneThatTurnedIsNamed) {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.error.plan_tolerance = 0.001;
    ap.error.diffuse = 0.005;
  }
  ASSERT_GE(room.access_points.size(), 3U);
  const auto several = std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {}));
  ChainWatch watch(several);
  for (int i = 0; i < 12; ++i) {
    auto frames = test::frames_at(several->room(),
                                  {0.2 * i - 1.1, 0.15 * (i % 7) - 0.5, 1.2},
                                  {4, 30.0, static_cast<unsigned>(i + 1)});
    for (CsiFrame& frame : frames) {
      frame.time += std::chrono::seconds(2 * i);
    }
    test::turn_chain(frames, 1, several->room().access_points[1].cores[1], kQuarter);
    watch.hear(frames);
  }
  const auto turned = watch.turned();
  ASSERT_EQ(turned.size(), 1U);
  EXPECT_EQ(turned[0].access_point, 1U);
}

// A device that lies at a place which looks more like another with turned chains says so once.
TEST(ChainWatch, TheSameAgainIsNoFurtherEvidence) {
  ChainWatch watch(localizer());
  for (int i = 0; i < 30; ++i) {
    auto frames = burst(0);
    for (CsiFrame& frame : frames) {
      frame.time += std::chrono::seconds(2 * i);
    }
    test::turn_chain(frames, 0, core(2), kQuarter);
    watch.hear(frames);
  }
  EXPECT_TRUE(watch.turned().empty());
}

}  // namespace
}  // namespace rayloc
