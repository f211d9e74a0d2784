// Networks that classify places: images, weights, and the two methods that use them.
#include "engine/baselines/places/weighted_places.h"

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/baselines/cifi/cifi.h"
#include "engine/baselines/dscp/dscp.h"
#include "engine/baselines/places/channel_images.h"
#include "engine/posterior/credible_region.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::places_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

const MacAddress kPhone = *parse_mac_address("02:00:00:00:00:01");

std::shared_ptr<const RoomModel> room() {
  static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
  return kRoom;
}

// --- Weights. ----------------------------------------------------------------------------------

TEST(WeightedPlaces, TwoOfEqualWeightAreTwoHypotheses) {
  WeightedPlaces weighted;
  weighted.places = {{-1.0, 0.0, 1.2}, {1.0, 0.5, 1.2}};
  weighted.weights = {0.5, 0.5};
  weighted.sigma = 0.1;
  LocationEstimate estimate;
  summarise_places(*room(), weighted, {}, estimate);
  ASSERT_GE(estimate.hypotheses.size(), 2U);
  EXPECT_NEAR(estimate.hypotheses[0].weight, 0.49, 0.02);
  EXPECT_NEAR(estimate.hypotheses[1].weight, 0.49, 0.02);
  EXPECT_TRUE(estimate.ambiguous);
  EXPECT_NEAR(estimate.position->x, 0.0, 1e-9) << "the mean, as published";
  EXPECT_NEAR(estimate.covariance[0], 1.01, 1e-6);
  EXPECT_GT(estimate.accuracy_m, 1.0);
  summarise_places(*room(), weighted, {.is_heaviest = true}, estimate);
  EXPECT_NEAR(std::abs(estimate.position->x), 1.0, 1e-9);
}

TEST(WeightedPlaces, MeanIsOfTheTenHeaviest) {
  WeightedPlaces weighted;
  for (int i = 0; i < 12; ++i) {
    weighted.places.push_back({static_cast<double>(i), 0.0, 0.0});
    weighted.weights.push_back(i < 2 ? 0.05 : 0.09);
  }
  EXPECT_NEAR(weighted.mean_of_heaviest().x, 6.5, 1e-12);
}

TEST(WeightedPlaces, SurroundingsReachHalfTheDistanceToTheNextPlace) {
  EXPECT_NEAR(surroundings_of({{0, 0, 0}, {0.4, 0, 0}, {0, 0.4, 0}, {0.4, 0.4, 0}}), 0.2, 1e-12);
}

// Truths are drawn from the tempered mixture: a region holds them as often as it states.
TEST(WeightedPlaces, RegionsContainDrawsAtTheirStatedRate) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal;
  std::size_t in_50 = 0;
  std::size_t in_95 = 0;
  constexpr std::size_t kDraws = 300;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    WeightedPlaces weighted;
    weighted.sigma = 0.12;
    weighted.residual = 0.02;
    for (int i = 0; i < 6; ++i) {
      weighted.places.push_back({2.4 * uniform(random) - 1.2, 1.8 * uniform(random) - 0.9, 1.2});
      weighted.weights.push_back(uniform(random));
    }
    const std::vector<double> weights = weighted.tempered();
    std::discrete_distribution<std::size_t> place(weights.begin(), weights.end());
    Vec3d truth = weighted.places[place(random)];
    truth.x += weighted.sigma * normal(random);
    truth.y += weighted.sigma * normal(random);
    LocationEstimate estimate;
    summarise_places(*room(), weighted, {}, estimate);
    const double reaching = region_reaching(estimate, truth).value();
    in_50 += reaching <= 0.5 ? 1U : 0U;
    in_95 += reaching <= 0.95 ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(in_50) / kDraws, 0.5, 0.1);
  EXPECT_GT(static_cast<double>(in_95) / kDraws, 0.93) << "hypotheses round up";
}

// Weights that are far too sure of the wrong place are tempered until the truth is likely.
TEST(WeightedPlaces, CertaintyFollowsHeldOutPlaces) {
  std::vector<HeldOutPlace> held;
  for (int i = 0; i < 40; ++i) {
    HeldOutPlace one;
    one.weighted.sigma = 0.2;
    one.weighted.places = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    one.weighted.weights = {0.998, 0.001, 0.001};
    one.truth = one.weighted.places[static_cast<std::size_t>(i % 4 == 0 ? 1 : 0)];
    held.push_back(one);
  }
  const PlaceCertainty certainty = fit_certainty(held);
  // Three quarters against a quarter: (0.998 / 0.001)^(1 / T) = 3 at the best temperature, or the
  // third place takes its share; T = ln 998 / ln 3 to 8.
  EXPECT_GT(certainty.temperature, 3.0);
  EXPECT_LT(certainty.temperature, 9.0);
  EXPECT_NEAR(certainty.residual, 0.02, 1e-12);
  for (HeldOutPlace& one : held) {
    one.truth = {50.0, 0.0, 0.0};
  }
  EXPECT_NEAR(fit_certainty(held).residual, 1.0, 1e-12);
}

// --- Images and methods. -----------------------------------------------------------------------

std::vector<CsiFrame> at(const Vec3d& place, unsigned seed, const MacAddress& sender = kPhone) {
  auto frames = test::frames_at(*room(), place, {.count = 6, .snr_db = 30.0, .seed = seed});
  for (CsiFrame& frame : frames) {
    frame.transmitter = sender;
  }
  return frames;
}

std::vector<TrainingPoint> survey(double step) {
  std::vector<TrainingPoint> points;
  unsigned seed = 1;
  for (double x = -1.0; x < 1.05; x += step) {
    for (double y = -0.8; y < 0.85; y += step) {
      const Vec3d place{x, y, 1.2};
      points.push_back({place, at(place, seed++)});
    }
  }
  return points;
}

TrainingInput input_of(double step) {
  TrainingInput input;
  input.room = room();
  input.points = survey(step);
  return input;
}

TEST(ChannelImages, ContainPhaseDifferencesIndependentOfFrameOffsets) {
  const std::vector<std::size_t> access_points = {0};
  const ImageKind kind = {
      NetworkKind::kLeNet,
      [](std::size_t antennas) { return antennas - 1; },
      [](const ImageFrame& frame, std::span<float> row) {
        for (std::size_t i = 0; i < row.size(); ++i) {
          row[i] = static_cast<float>(std::arg(frame.h[i + frame.tones] * std::conj(frame.h[i])));
        }
      }};
  const Vec3d place{0.3, -0.4, 1.2};
  LocationEstimate estimate;
  const auto frames = test::frames_at(*room(), place, {.count = 3, .snr_db = 70.0, .seed = 4});
  const BurstImages drawn =
      burst_images(*room(), access_points, frames, kind, {.count = 2, .seed = 1}, estimate);
  ASSERT_EQ(drawn.images.size(), 2U);
  const auto truth = test::channel_at(*room(), room()->access_points[0], place);
  const std::size_t tones = room()->grid.size();
  for (std::size_t pair = 0; pair < 2; ++pair) {
    for (std::size_t r = 0; r < kImageRows; ++r) {
      for (std::size_t k = 0; k < tones; ++k) {
        const double expected =
            std::arg(truth[(pair + 1) * tones + k] * std::conj(truth[pair * tones + k]));
        const double value{drawn.images[0][(pair * kImageRows + r) * tones + k]};
        EXPECT_LT(std::abs(std::remainder(value - expected, 2.0 * std::numbers::pi)), 0.05);
      }
    }
  }
  EXPECT_EQ(estimate.access_points_used, 1U);
}

// A network that was shown places finds them again from other frames.
TEST(Cifi, FindsThePlacesItHasSeen) {
  TrainingInput input = input_of(0.5);
  input.values = {{"epochs", 12.0}, {"images", 8.0}};
  std::size_t epochs = 0;
  input.keep = [&](const TrainingCheckpoint&) { ++epochs; };
  std::vector<double> shares;
  input.progress = [&](const TrainingProgress& progress) { shares.push_back(progress.share); };
  const auto training = train_cifi(input);
  ASSERT_TRUE(training) << training.error().message;
  EXPECT_EQ(epochs, 24U) << "two stages";
  EXPECT_DOUBLE_EQ(shares.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ((*training)->network->places.size(), input.points.size());
  EXPECT_NEAR((*training)->network->sigma, 0.25, 1e-9);
  auto cifi = make_cifi(room(), {}, 1, 0.95, *training);
  ASSERT_TRUE(cifi) << cifi.error().message;
  std::size_t right = 0;
  for (std::size_t i = 0; i < input.points.size(); ++i) {
    const Vec3d& place = input.points[i].position;
    const LocationEstimate estimate = cifi->locate(at(place, 1000 + static_cast<unsigned>(i)), 0);
    ASSERT_TRUE(estimate.position) << estimate.reason;
    right +=
        std::hypot(estimate.position->x - place.x, estimate.position->y - place.y) < 0.2 ? 1U : 0U;
  }
  EXPECT_GT(right, input.points.size() * 8 / 10);
}

TEST(Cifi, GoesOnWhereItWasInterrupted) {
  TrainingInput input = input_of(0.5);
  input.values = {{"epochs", 2.0}, {"images", 4.0}};
  std::vector<TrainingCheckpoint> kept;
  input.keep = [&](const TrainingCheckpoint& checkpoint) { kept.push_back(checkpoint); };
  const auto whole = train_cifi(input);
  ASSERT_TRUE(whole);
  ASSERT_EQ(kept.size(), 4U);
  for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
    TrainingInput again = input_of(0.5);
    again.values = input.values;
    again.resume = kept[i];
    const auto resumed = train_cifi(again);
    ASSERT_TRUE(resumed);
    EXPECT_EQ((*resumed)->network->parameters, (*whole)->network->parameters) << i;
    EXPECT_EQ((*resumed)->network->temperature, (*whole)->network->temperature);
    EXPECT_EQ((*resumed)->network->loss, (*whole)->network->loss);
  }
}

TEST(Cifi, StopsAfterAnEpochOnRequest) {
  TrainingInput input = input_of(0.5);
  input.values = {{"epochs", 2.0}, {"images", 2.0}};
  for (const std::size_t last : {std::size_t{1}, std::size_t{3}}) {
    std::size_t epochs = 0;
    input.keep = [&](const TrainingCheckpoint&) { ++epochs; };
    input.stop_requested = [&] { return epochs == last; };
    const auto stopped = train_cifi(input);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().kind, ErrorKind::kUnavailable);
    EXPECT_EQ(epochs, last);
  }
}

std::shared_ptr<const Training> quick_cifi() {
  static const auto kTraining = [] {
    TrainingInput input = input_of(0.5);
    input.values = {{"epochs", 1.0}};
    return *train_cifi(input);
  }();
  return kTraining;
}

TEST(Cifi, RefusesInvalidInputsWithAMessage) {
  const auto without = make_cifi(room(), {}, 1, 0.95, nullptr);
  ASSERT_FALSE(without);
  EXPECT_EQ(without.error().kind, ErrorKind::kConfiguration);
  EXPECT_EQ(without.error().message, "no training of cifi: run rayloc train SITE --method cifi");
  const auto other = make_cifi(room(), {{"input", std::string("aoa")}}, 1, 0.95, quick_cifi());
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message,
            "--baseline input=aoa: trained with input=phase; leave it out, or train again (rayloc "
            "train)");
  auto changed = std::make_shared<Training>(*quick_cifi());
  changed->network->parameters.pop_back();
  EXPECT_THAT(make_cifi(room(), {}, 1, 0.95, changed).error().message,
              HasSubstr("the weights of the training are not those of this network"));
  changed = std::make_shared<Training>(*quick_cifi());
  changed->access_points[0].id = "cellar";
  EXPECT_THAT(make_cifi(room(), {}, 1, 0.95, changed).error().message,
              HasSubstr("trained with cellar, which the site does not have"));
  changed = std::make_shared<Training>(*quick_cifi());
  changed->network->mean.pop_back();
  EXPECT_THAT(make_cifi(room(), {}, 1, 0.95, changed).error().message,
              HasSubstr("trained with other antennas or tones than the site has"));
  TrainingInput few = input_of(0.5);
  few.points.resize(9);
  EXPECT_EQ(train_cifi(few).error().message,
            "cifi needs 10 places or more at which an access point received the transmitter; the "
            "survey has 9");
}

TEST(Cifi, ReportsTheReasonForNoFix) {
  auto cifi = *make_cifi(room(), {}, 1, 0.95, quick_cifi());
  EXPECT_EQ(cifi.locate({}, 0).reason, "no frames");
  auto frames = at({0.1, 0.1, 1.2}, 1);
  for (CsiFrame& frame : frames) {
    frame.access_point = 99;
  }
  const LocationEstimate estimate = cifi.locate(frames, 0);
  EXPECT_FALSE(estimate.position);
  EXPECT_EQ(estimate.reason, "no access point used in training received the burst");
  frames = at({0.1, 0.1, 1.2}, 1);
  EXPECT_TRUE(cifi.locate({frames.data(), 1}, 0).position) << "one frame is enough";
}

TEST(Cifi, IsTheSameTwice) {
  auto first = *make_cifi(room(), {}, 1, 0.95, quick_cifi());
  auto second = *make_cifi(room(), {}, 1, 0.95, quick_cifi());
  const auto frames = at({0.1, 0.1, 1.2}, 1);
  const LocationEstimate a = first.locate(frames, 3);
  first.locate(frames, 4);
  const LocationEstimate b = second.locate(frames, 3);
  EXPECT_EQ(a.position->x, b.position->x);
  EXPECT_EQ(a.accuracy_m, b.accuracy_m);
  EXPECT_EQ(first.locate(frames, 3).position->x, a.position->x);
}

TEST(Cifi, ThePublishedAngleIsAnotherInput) {
  TrainingInput input = input_of(0.5);
  input.values = {{"epochs", 1.0}, {"input", std::string("aoa")}};
  const auto training = train_cifi(input);
  ASSERT_TRUE(training);
  EXPECT_EQ((*training)->network->mean.size(), 6U) << "two pairs of three access points";
  auto cifi = make_cifi(room(), {}, 1, 0.95, *training);
  ASSERT_TRUE(cifi) << "what it was trained with is what it locates with";
  EXPECT_TRUE(cifi->locate(at({0.1, 0.1, 1.2}, 1), 0).position);
}

// The channel of a fixed transmitter, changed by a person: here by the place of the sender.
TEST(Dscp, RecognisesTheEmptyRoomAndPlaces) {
  TrainingInput input = input_of(0.5);
  input.values = {{"epochs", 12.0}, {"images", 8.0}};
  input.empty = at({1.2, 1.0, 0.5}, 77);
  input.transmitter = kPhone;
  const auto training = train_dscp(input);
  ASSERT_TRUE(training) << training.error().message;
  EXPECT_TRUE((*training)->network->has_empty_room);
  EXPECT_EQ((*training)->network->mean.size(), 9U) << "three pairs of three access points";
  auto dscp = make_dscp(room(), {}, 1, 0.95, *training);
  ASSERT_TRUE(dscp);
  EXPECT_EQ(dscp->locate(at({1.2, 1.0, 0.5}, 78), 0).reason, "no person detected");
  std::size_t right = 0;
  for (const TrainingPoint& point : input.points) {
    const LocationEstimate estimate = dscp->locate(at(point.position, 500), 0);
    right += estimate.position && std::hypot(estimate.position->x - point.position.x,
                                             estimate.position->y - point.position.y) < 0.25
                 ? 1U
                 : 0U;
  }
  EXPECT_GT(right, input.points.size() * 8 / 10);
}

TEST(Dscp, MergesPlacesToAreas) {
  TrainingInput input = input_of(0.25);
  input.values = {{"cell_m", 0.5}, {"epochs", 1.0}, {"images", 2.0}};
  const auto training = train_dscp(input);
  ASSERT_TRUE(training);
  EXPECT_LT((*training)->network->places.size(), input.points.size() / 2);
  const auto other = make_dscp(room(), {{"cell_m", 1.0}}, 1, 0.95, *training);
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("trained with cell_m=0.5"));
}

using MakeClassifier = decltype(&make_cifi);
using TrainClassifier = decltype(&train_cifi);
struct Classifier {
  std::string name;
  MakeClassifier make;
  TrainClassifier train;
};

std::ostream& operator<<(std::ostream& out, const Classifier& one) { return out << one.name; }

class EachClassifier : public ::testing::TestWithParam<Classifier> {};
INSTANTIATE_TEST_SUITE_P(Places,
                         EachClassifier,
                         ::testing::Values(Classifier{"cifi", &make_cifi, &train_cifi},
                                           Classifier{"dscp", &make_dscp, &train_dscp}),
                         [](const auto& row) { return row.param.name; });

TEST_P(EachClassifier, RefusesASiteWithoutATraining) {
  const auto made = GetParam().make(room(), {}, 1, 0.95, nullptr);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(made.error().message, HasSubstr("rayloc train SITE --method " + GetParam().name));
}

TEST_P(EachClassifier, RefusesASurveyOfTooFewPlaces) {
  TrainingInput input = input_of(0.5);
  input.points.resize(9);
  const auto trained = GetParam().train(input);
  ASSERT_FALSE(trained);
  EXPECT_THAT(trained.error().message,
              AllOf(HasSubstr(GetParam().name), HasSubstr("10 places"), HasSubstr("has 9")));
}

TEST_P(EachClassifier, RefusesAccessPointsOfOneAntenna) {
  auto one = std::make_shared<RoomModel>(*room());
  one->access_points.resize(1);
  one->access_points[0].rx_chains.resize(1);
  one->access_points[0].array.element_offset.resize(1);
  one->access_points[0].gains = test::make_gains(*one, 0);
  TrainingInput input = input_of(0.5);
  input.room = one;
  const auto trained = GetParam().train(input);
  ASSERT_FALSE(trained);
  EXPECT_EQ(trained.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(trained.error().message,
              AllOf(HasSubstr(GetParam().name), HasSubstr("two antennas")));
}

// Nothing that a radio may send takes the process down.
TEST(Places, HandleInvalidBursts) {
  auto cifi = *make_cifi(room(), {}, 1, 0.95, quick_cifi());
  std::mt19937 random(1);
  auto dead = at({0.2, 0.1, 1.2}, 9);
  test::kill_chain(dead, 0, room()->access_points[0].rx_chains[1], random);
  EXPECT_TRUE(cifi.locate(dead, 0).position);
  auto broken = at({0.2, 0.1, 1.2}, 9);
  for (std::size_t i = 0; i < broken.size(); ++i) {
    broken[i].rx_chains.resize(i % 3);
  }
  const LocationEstimate estimate = cifi.locate(broken, 0);
  EXPECT_EQ(estimate.position.has_value(), estimate.reason.empty());
}

}  // namespace
}  // namespace rayloc::places_test
