#include "engine/track/cloud_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "engine/base/normal_draws.h"
#include "tests/support/cloud_scene.h"

namespace rayloc::cloud_evidence_test {
namespace {

constexpr float kMinFactor = static_cast<float>(CloudEvidence::kMinOutlier);
const Vec3d kHere{0.3, -0.4, 1.2};
const Vec3d kThere{-0.9, 0.6, 1.2};

std::shared_ptr<const CloudRoom> room() {
  static const auto kRoom = test::cloud_room(test::make_room());
  return kRoom;
}

double exponent() { return room()->localizer->room().likelihood_exponent; }

// Log-likelihoods of an access point.
using Values = std::function<double(const Vec3d&)>;

Values hill(const Vec3d& at, double height, double sigma = 0.1) {
  return [=](const Vec3d& p) {
    const double d = norm(p - at) / sigma;
    return height * std::exp(-0.5 * d * d) - 2.0;
  };
}

Values constant(double value) {
  return [=](const Vec3d&) { return value; };
}

// As PlaceSearch, with any values.
CloudEvidence::Compare compare_by(std::vector<Values> arrays) {
  return [arrays](const RoomObservation& observation,
                  const SearchedPlaces& places,
                  PlaceSearch::Spread) {
    std::vector<std::vector<float>> values;
    for (const ArrayObservation& one : observation.arrays) {
      std::vector<float>& v = values.emplace_back();
      for (std::size_t i = 0; i < places.x.size(); ++i) {
        const Vec3d at{static_cast<double>(places.x[i]),
                       static_cast<double>(places.y[i]),
                       static_cast<double>(places.z[i])};
        v.push_back(places.box[i] == BoxLattice::kNone ? PlaceSearch::kNotCompared
                                                       : static_cast<float>(arrays[one.ap](at)));
      }
      while (v.size() % 8 != 0) {
        v.push_back(v.back());
      }
    }
    return values;
  };
}

RoomObservation moment(std::size_t arrays, int ms = 0) {
  RoomObservation observation;
  for (std::size_t i = 0; i < arrays; ++i) {
    observation.arrays.emplace_back().ap = i;
  }
  observation.estimate.time = Timestamp(std::chrono::milliseconds(ms));
  return observation;
}

struct Cloud {
  PlaceCloud places;
  std::vector<std::uint32_t> boxes;

  void add(const Vec3d& at) {
    CloudPlace place;
    place.x = static_cast<float>(at.x);
    place.y = static_cast<float>(at.y);
    place.z = static_cast<float>(at.z);
    places.add(place, 0.0F);
    boxes.push_back(room()->lattice.box_at(place.x, place.y, place.z));
  }
};

Cloud around(const Vec3d& at, std::size_t count, double sigma = 0.05) {
  NormalDraws draws(1);
  Cloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = sigma * static_cast<double>(draws.normal());
    const double y = sigma * static_cast<double>(draws.normal());
    cloud.add(at + Vec3d{x, y, 0.0});
  }
  return cloud;
}

std::optional<CloudEvidence::Weights> weigh(CloudEvidence& evidence,
                                            const Cloud& cloud,
                                            const RoomObservation& observation,
                                            double weight = 1.0) {
  return evidence.weigh(observation, cloud.places, cloud.boxes, weight);
}

TEST(CloudEvidence, WeighsByTheRatioToTheMeanOfTheRoom) {
  CloudEvidence evidence(room(), compare_by({constant(7.0)}));
  const Cloud cloud = around(kHere, 16);
  const auto weights = weigh(evidence, cloud, moment(1));
  ASSERT_TRUE(weights);
  for (const float factor : weights->factor) {
    EXPECT_NEAR(factor, 1.0, 1e-5);
  }
  EXPECT_NEAR(weights->best, 7.0, 0.1);
  EXPECT_EQ(weights->outlier, CloudEvidence::kMinOutlier);
}

// Many moments that fit every place equally leave the odds of the cloud against the rest.
TEST(CloudEvidence, ConstantMomentsLeaveTheOdds) {
  for (const std::size_t arrays : {1U, 3U}) {
    CloudEvidence evidence(room(), compare_by(std::vector(arrays, constant(7.0))));
    Cloud cloud = around(kHere, 16);
    double log_odds = 0.0;
    for (int ms = 0; ms < 10'000; ms += 50) {
      const auto weights = weigh(evidence, cloud, moment(arrays, ms), 0.25);
      ASSERT_TRUE(weights);
      log_odds += cloud.places.weigh(weights->factor);
    }
    EXPECT_NEAR(log_odds, 0.0, 1e-3) << arrays;
  }
}

TEST(CloudEvidence, TempersByTheExponentAndTheWeight) {
  const Values values = [](const Vec3d& p) { return 5.0 + 4.0 * p.x; };
  Cloud cloud;
  cloud.add(kHere);
  cloud.add(kHere + Vec3d{0.5, 0.0, 0.0});
  for (const double weight : {1.0, 0.3, 0.05}) {
    CloudEvidence evidence(room(), compare_by({values}));
    const auto weights = weigh(evidence, cloud, moment(1), weight);
    ASSERT_TRUE(weights);
    const float ratio = (weights->factor[1] - kMinFactor) / (weights->factor[0] - kMinFactor);
    EXPECT_NEAR(std::log(ratio), weight * exponent() * 2.0, 1e-3);
  }
}

TEST(CloudEvidence, PadsWithTheLastPlace) {
  for (std::size_t count = 1; count <= 17; ++count) {
    CloudEvidence evidence(room(), compare_by({hill(kHere, 10.0)}));
    const auto weights = weigh(evidence, around(kHere, count), moment(1));
    ASSERT_TRUE(weights);
    ASSERT_EQ(weights->factor.size(), (count + 7) / 8 * 8);
    for (std::size_t i = count; i < weights->factor.size(); ++i) {
      EXPECT_EQ(weights->factor[i], weights->factor[count - 1]);
    }
  }
}

TEST(CloudEvidence, GivesNoWeightToAPlaceWithoutABox) {
  Cloud cloud = around(kHere, 20);
  cloud.boxes[3] = BoxLattice::kNone;
  cloud.boxes[19] = BoxLattice::kNone;
  for (const std::size_t arrays : {1U, 3U}) {
    CloudEvidence evidence(room(), compare_by(std::vector(arrays, hill(kHere, 10.0))));
    const auto weights = weigh(evidence, cloud, moment(arrays));
    ASSERT_TRUE(weights);
    for (std::size_t i = 0; i < weights->factor.size(); ++i) {
      if (i == 3 || i >= 19) {
        EXPECT_EQ(weights->factor[i], 0.0F);
      } else {
        EXPECT_GE(weights->factor[i], kMinFactor);
      }
    }
  }
}

TEST(CloudEvidence, BoundsTheLossByTheOutlier) {
  for (const std::size_t arrays : {1U, 2U, 3U}) {
    CloudEvidence evidence(room(), compare_by(std::vector(arrays, hill(kHere, 3000.0, 0.2))));
    Cloud cloud = around(kHere, 40, 0.02);
    cloud.add(kThere);
    const auto weights = weigh(evidence, cloud, moment(arrays));
    ASSERT_TRUE(weights);
    EXPECT_TRUE(std::all_of(weights->factor.begin(), weights->factor.end(), [](float one) {
      return std::isfinite(one) && one >= kMinFactor;
    }));
    EXPECT_NEAR(weights->factor[40], weights->outlier, 1e-3);
    EXPECT_GT(*std::max_element(weights->factor.begin(), weights->factor.end()), 1.0F);
  }
}

TEST(CloudEvidence, AnUnexplainedMomentChangesNothing) {
  std::vector<Values> values = {hill(kHere, 12.0), hill(kHere, 9.0)};
  const Cloud cloud = around(kHere, 100);
  CloudEvidence one(room(), compare_by(values));
  CloudEvidence other(room(), [&](const auto& observation, const auto& places, auto spread) {
    const bool is_explained = observation.estimate.time != Timestamp(std::chrono::milliseconds(5));
    return compare_by(is_explained ? values : std::vector(2, constant(-3.0)))(
        observation, places, spread);
  });
  ASSERT_TRUE(weigh(one, cloud, moment(2)) && weigh(other, cloud, moment(2)));
  EXPECT_FALSE(weigh(other, cloud, moment(2, 5)));
  Cloud lost = cloud;
  std::fill(lost.boxes.begin(), lost.boxes.end(), BoxLattice::kNone);
  EXPECT_FALSE(weigh(other, lost, moment(2, 7)));
  EXPECT_EQ(weigh(one, cloud, moment(2, 9))->factor, weigh(other, cloud, moment(2, 9))->factor);
}

TEST(CloudEvidence, LeavesOutAnAccessPointThatNoPlaceExplains) {
  const Cloud cloud = around(kHere, 100);
  CloudEvidence both(room(), compare_by({hill(kHere, 12.0), constant(-1.0)}));
  CloudEvidence one(room(), compare_by({hill(kHere, 12.0)}));
  EXPECT_EQ(weigh(both, cloud, moment(2))->factor, weigh(one, cloud, moment(1))->factor);
}

// A place anywhere in the room explains the moment: the cloud is wrong, not the moment.
TEST(CloudEvidence, TheRoomMayExplainAMomentThatTheCloudDoesNot) {
  const Values values = [](const Vec3d& p) { return norm(p - kHere) < 0.3 ? -4.0 : 3.0; };
  CloudEvidence evidence(room(), compare_by({values}));
  const auto weights = weigh(evidence, around(kHere, 50), moment(1));
  ASSERT_TRUE(weights);
  EXPECT_LT(weights->factor[0], 0.1F);
}

// Two access points agree on a place, and the third fits another one as well as they fit theirs.
TEST(CloudEvidence, AFaultyAccessPointIsOutvoted) {
  CloudEvidence evidence(room(),
                         compare_by({hill(kHere, 25.0), hill(kHere, 25.0), hill(kThere, 25.0)}));
  Cloud cloud = around(kHere, 100, 0.03);
  const std::size_t first = cloud.boxes.size();
  for (std::size_t i = 0; i < 100; ++i) {
    cloud.add(kThere + Vec3d{0.001 * static_cast<double>(i), 0.0, 0.0});
  }
  for (int ms = 0; ms < 500; ms += 50) {
    const auto weights = weigh(evidence, cloud, moment(3, ms));
    ASSERT_TRUE(weights);
    const auto middle = weights->factor.begin() + static_cast<std::ptrdiff_t>(first);
    const float best = *std::max_element(weights->factor.begin(), middle);
    EXPECT_GT(best, 1.0F);
    EXPECT_LT(*std::max_element(middle, weights->factor.end()), 0.1F * best);
    EXPECT_LT(weights->outlier, 0.1);
  }
}

TEST(CloudEvidence, AccessPointsThatContradictEachOtherAreAnOutlier) {
  const std::vector<Values> values = {
      hill({0.9, 0.8, 1.2}, 30.0), hill(kThere, 30.0), hill(kHere, 30.0)};
  Cloud cloud;
  for (const Vec3d& at : {Vec3d{0.9, 0.8, 1.2}, kThere, kHere}) {
    for (std::size_t i = 0; i < 40; ++i) {
      cloud.add(at + Vec3d{0.001 * static_cast<double>(i), 0.0, 0.0});
    }
  }
  CloudEvidence evidence(room(), compare_by(values));
  const auto weights = weigh(evidence, cloud, moment(3));
  ASSERT_TRUE(weights);
  EXPECT_GT(weights->outlier, 0.3);
  const auto least = *std::min_element(weights->factor.begin(), weights->factor.end());
  EXPECT_GE(least, static_cast<float>(weights->outlier) - 1e-6F);
}

// Reception that is worse for all access points is no contradiction.
TEST(CloudEvidence, AWeakerMomentIsNoOutlier) {
  double scale = 1.0;
  const CloudEvidence::Compare compare = [&](const auto& observation, const auto& places, auto s) {
    return compare_by(std::vector(observation.arrays.size(), hill(kHere, 40.0 * scale)))(
        observation, places, s);
  };
  const Cloud cloud = around(kHere, 200, 0.02);
  for (const std::size_t arrays : {1U, 2U, 3U}) {
    scale = 1.0;
    CloudEvidence evidence(room(), compare);
    for (int ms = 0; ms < 1000; ms += 50) {
      ASSERT_TRUE(weigh(evidence, cloud, moment(arrays, ms)));
    }
    scale = 0.5;
    const auto weights = weigh(evidence, cloud, moment(arrays, 1000));
    ASSERT_TRUE(weights);
    EXPECT_EQ(weights->outlier, CloudEvidence::kMinOutlier);
    EXPECT_GT(*std::max_element(weights->factor.begin(), weights->factor.end()), 1.0F);
  }
}

// The places of the room that a moment is compared with: by its time alone, and inside their boxes.
TEST(CloudEvidence, TheSampleFollowsFromTheTime) {
  std::vector<std::vector<float>> seen;
  std::set<std::uint32_t> boxes;
  const CloudEvidence::Compare compare = [&](const auto& observation, const auto& places, auto s) {
    if (s == PlaceSearch::Spread::kApart) {
      std::vector<float>& one = seen.emplace_back(places.x.begin(), places.x.end());
      one.insert(one.end(), places.y.begin(), places.y.end());
      for (std::size_t i = 0; i < places.x.size(); ++i) {
        EXPECT_EQ(room()->lattice.box_at(places.x[i], places.y[i], places.z[i]), places.box[i]);
        boxes.insert(places.box[i]);
      }
    }
    return compare_by({constant(1.0)})(observation, places, s);
  };
  CloudEvidence one(room(), compare);
  CloudEvidence other(room(), compare);
  const Cloud cloud = around(kHere, 8);
  weigh(one, cloud, moment(1, 100));
  EXPECT_EQ(boxes.size(), kBoxesOfMoment);
  weigh(one, cloud, moment(1, 150));
  weigh(other, around(kThere, 30), moment(1, 150));
  weigh(other, cloud, moment(1, 100));
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_EQ(seen[0], seen[3]);
  EXPECT_EQ(seen[1], seen[2]);
  EXPECT_NE(seen[0], seen[1]);
  for (int ms = 0; ms < 10'000; ms += 50) {
    weigh(one, cloud, moment(1, ms));
  }
  EXPECT_GT(boxes.size(), kSampleBoxes / 2);  // all of them in turn
}

std::vector<std::vector<float>> factors_of_a_walk(const std::shared_ptr<const CloudRoom>& of) {
  CloudEvidence evidence(of);
  std::vector<std::vector<float>> factors;
  for (int n = 0; n < 4; ++n) {
    const Vec3d at = kHere + Vec3d{0.05 * n, 0.02 * n, 0.0};
    const auto seed = static_cast<unsigned>(n + 1);
    auto frames = test::frames_at(of->localizer->room(), at, {1, 30.0, seed});
    for (CsiFrame& frame : frames) {
      frame.time = Timestamp(std::chrono::milliseconds(50 * n));
    }
    const Cloud cloud = around(at, 200, 0.06);
    const auto weights = weigh(evidence, cloud, of->localizer->receive(frames), 0.5);
    factors.push_back(weights ? weights->factor : std::vector<float>{});
  }
  return factors;
}

// Boxes that are kept, and boxes that are made anew.
TEST(CloudEvidence, GivesTheSameBytesForTheSameMoments) {
  const auto first = factors_of_a_walk(room());
  EXPECT_EQ(first, factors_of_a_walk(room()));
  EXPECT_EQ(first, factors_of_a_walk(test::cloud_room(test::make_room())));
}

TEST(CloudEvidence, PrefersThePlaceOfADevice) {
  for (const std::vector<float>& factors : factors_of_a_walk(room())) {
    ASSERT_FALSE(factors.empty());
  }
  CloudEvidence evidence(room());
  Cloud cloud = around(kHere, 200, 0.003);
  for (std::size_t i = 0; i < 200; ++i) {
    cloud.add(kThere + Vec3d{0.001 * static_cast<double>(i), 0.0, 0.0});
  }
  const auto& localizer = *room()->localizer;
  const auto weights =
      weigh(evidence, cloud, localizer.receive(test::frames_at(localizer.room(), kHere)));
  ASSERT_TRUE(weights);
  const auto middle = weights->factor.begin() + 200;
  EXPECT_GT(*std::max_element(weights->factor.begin(), middle), 3.0F);
  EXPECT_LT(*std::max_element(middle, weights->factor.end()), 0.5F);
  EXPECT_EQ(weights->outlier, CloudEvidence::kMinOutlier);
}

}  // namespace
}  // namespace rayloc::cloud_evidence_test
