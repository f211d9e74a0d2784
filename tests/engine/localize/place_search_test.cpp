#include "engine/localize/place_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "engine/localize/localizer.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/scenes.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::place_search_test {
namespace {

const MacAddress kDevice = *parse_mac_address("02:52:4c:00:00:01");
const Vec3d kTruth{0.32, -0.41, 1.27};
const Vec3d kInCupboard{0.95, 0.6, 1.2};
constexpr double kExponent = 0.6;

// Two access points, devices at unknown heights, and a cupboard that no ray enters.
RoomModel make_room() {
  RoomModel room = test::make_room();
  room.scene = test::make_scene({{"floor", test::box_mesh({-1.5, -1.2, -0.1}, {1.5, 1.2, 0.0})},
                                 {"west", test::box_mesh({-1.6, -1.2, 0.0}, {-1.5, 1.2, 2.5})},
                                 {"south", test::box_mesh({-1.5, -1.3, 0.0}, {1.5, -1.2, 2.5})},
                                 {"cupboard", test::box_mesh({0.6, 0.2, -0.05}, {1.3, 1.0, 2.4})}},
                                test::kConcrete);
  room.device.height_sigma = 0.2;
  room.access_points.erase(room.access_points.begin() + 1);
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    RoomAccessPoint& ap = room.access_points[i];
    ap.gains = test::make_gains(room, i);
    ap.error.plan_tolerance = 0.002;
    ap.error.diffuse = 0.01;
  }
  room.access_points[0].powers = {{kDevice, -10.0, 3.0}};
  return room;
}

const Localizer& localizer() {
  static const Localizer kLocalizer =
      *Localizer::create(std::make_shared<const RoomModel>(make_room()), {});
  return kLocalizer;
}

std::vector<CsiFrame> frames() {
  auto result = test::frames_at(localizer().room(), kTruth, {1, 30.0, 1});
  for (CsiFrame& frame : result) {
    frame.transmitter = kDevice;
    frame.power_dbm.assign(frame.rx_chains.size(), -60.0F);
  }
  return result;
}

struct Places {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;
  std::vector<std::uint32_t> box;

  void add(const Vec3d& at, const BoxLattice& lattice) {
    x.push_back(static_cast<float>(at.x));
    y.push_back(static_cast<float>(at.y));
    z.push_back(static_cast<float>(at.z));
    box.push_back(lattice.box_at(x.back(), y.back(), z.back()));
  }
  SearchedPlaces all() const { return {x, y, z, box}; }
  std::size_t cell(std::size_t i, const BoxLattice& lattice) const {
    return lattice.grid().cell_at(static_cast<double>(x[i]), static_cast<double>(y[i]));
  }
};

const BoxLattice& lattice_of(const RoomObservation& observation) {
  return observation.arrays.front().map->box_lattice();
}

// Normal about the truth, and a few in the cupboard.
Places cloud(const BoxLattice& lattice, std::size_t count, double sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, sigma);
  Places places;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = normal(random);
    const double y = normal(random);
    const Vec3d& middle = i % 40 == 39 ? kInCupboard : kTruth;
    places.add(middle + Vec3d{x, y, normal(random)}, lattice);
  }
  return places;
}

// The values of the places of one box, each box by itself.
std::vector<float> one_box(const ArrayObservation& array, const Places& places, std::uint32_t box) {
  const AccessPointMap& map = *array.map;
  const DelayRows rows = delay_rows(array.observed.array, array.h.size());
  const int noise_class =
      noise_class_of(static_cast<double>(rows.noise), map.access_point().error.noise);
  ObservedBurst observed = array.observed;
  observed.array.noise = static_cast<double>(rows.noise);
  const auto null_model = static_cast<float>(map.null_model(observed));
  const auto terms = map.place_box(box, noise_class);
  const Vec3d middle = map.box_lattice().middle(box);
  BoxBurst burst;
  if (terms->is_reachable()) {
    whiten_delays_of_box(*terms, rows, {}, burst);
  }
  std::vector<float> values;
  for (std::size_t i = 0; i < places.box.size(); ++i) {
    if (places.box[i] != box) {
      continue;
    }
    const float x = places.x[i] - static_cast<float>(middle.x);
    const float y = places.y[i] - static_cast<float>(middle.y);
    const float z = places.z[i] - static_cast<float>(middle.z);
    float value = 0.0F;
    if (terms->is_reachable()) {
      evaluate_places_of_box(*terms, burst, {{&x, 1}, {&y, 1}, {&z, 1}}, {&value, 1});
      value -= null_model;
    }
    const std::size_t cell = places.cell(i, map.box_lattice());
    value += static_cast<float>(array.power_log_likelihood_at(cell, kExponent));
    values.push_back(value);
  }
  return values;
}

void expect_boxes_by_themselves(const RoomObservation& observation, const Places& places) {
  PlaceSearch search(observation, kExponent);
  const auto all = search.log_likelihoods(places.all(), PlaceSearch::Spread::kApart);
  std::set<std::uint32_t> boxes(places.box.begin(), places.box.end());
  boxes.erase(BoxLattice::kNone);
  EXPECT_EQ(search.boxes(), boxes.size());
  ASSERT_EQ(all.size(), observation.arrays.size());
  for (std::size_t a = 0; a < all.size(); ++a) {
    for (const std::uint32_t box : boxes) {
      std::vector<float> values;
      for (std::size_t i = 0; i < places.box.size(); ++i) {
        if (places.box[i] == box) {
          values.push_back(all[a][i]);
        }
      }
      EXPECT_EQ(values, one_box(observation.arrays[a], places, box));
    }
  }
}

TEST(PlaceSearch, EqualsOneBoxAtATime) {
  const RoomObservation observation = localizer().receive(frames());
  ASSERT_EQ(observation.arrays.size(), 2U);
  ASSERT_FALSE(observation.arrays[0].power_log_likelihood.empty());
  ASSERT_TRUE(PlaceSearch::can_search(observation));
  expect_boxes_by_themselves(observation, cloud(lattice_of(observation), 300, 0.15));
}

TEST(PlaceSearch, LeavesOutADeadChain) {
  auto received = frames();
  std::mt19937 random(1);
  test::kill_chain(received, 1, localizer().room().access_points[1].rx_chains[1], random);
  const RoomObservation observation = localizer().receive(received);
  ASSERT_EQ(observation.arrays.size(), 2U);
  ASSERT_EQ(observation.arrays[1].map->antennas(), 2U);
  expect_boxes_by_themselves(observation, cloud(lattice_of(observation), 60, 0.1));
}

// The hint follows from the fullest box, which the order does not change.
TEST(PlaceSearch, DoesNotDependOnTheOrderOfPlaces) {
  const RoomObservation observation = localizer().receive(frames());
  const Places places = cloud(lattice_of(observation), 400, 0.2);
  std::vector<std::size_t> order(places.x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  Places mixed;
  for (const std::size_t i : order) {
    mixed.x.push_back(places.x[i]);
    mixed.y.push_back(places.y[i]);
    mixed.z.push_back(places.z[i]);
    mixed.box.push_back(places.box[i]);
  }
  PlaceSearch search(observation, kExponent);
  for (const auto spread : {PlaceSearch::Spread::kTogether, PlaceSearch::Spread::kApart}) {
    const auto one = search.log_likelihoods(places.all(), spread);
    const auto other = search.log_likelihoods(mixed.all(), spread);
    for (std::size_t a = 0; a < one.size(); ++a) {
      for (std::size_t n = 0; n < order.size(); ++n) {
        EXPECT_EQ(other[a][n], one[a][order[n]]);
      }
    }
  }
}

// The fullest box of a cloud has a search of its own.
TEST(PlaceSearch, EvaluatesTheFullestBoxAsAnyBoxApart) {
  const RoomObservation observation = localizer().receive(frames());
  const Places places = cloud(lattice_of(observation), 400, 0.1);
  PlaceSearch search(observation, kExponent);
  const auto together = search.log_likelihoods(places.all(), PlaceSearch::Spread::kTogether);
  const auto apart = search.log_likelihoods(places.all(), PlaceSearch::Spread::kApart);
  const auto count = [&](std::uint32_t box) {
    return std::count(places.box.begin(), places.box.end(), box);
  };
  std::uint32_t fullest = places.box[0];
  for (const std::uint32_t box : places.box) {
    if (count(box) > count(fullest) || (count(box) == count(fullest) && box < fullest)) {
      fullest = box;
    }
  }
  for (std::size_t a = 0; a < apart.size(); ++a) {
    for (std::size_t i = 0; i < places.box.size(); ++i) {
      if (places.box[i] == fullest) {
        EXPECT_EQ(together[a][i], apart[a][i]);
      }
    }
  }
}

// The delay of the fullest box is good for the others, and their obstructed cases are their own.
TEST(PlaceSearch, OtherBoxesHardlyDifferFromBoxesApart) {
  const RoomObservation observation = localizer().receive(frames());
  const Places places = cloud(lattice_of(observation), 1000, 0.15);
  PlaceSearch search(observation, kExponent);
  const auto together = search.log_likelihoods(places.all(), PlaceSearch::Spread::kTogether);
  const auto apart = search.log_likelihoods(places.all(), PlaceSearch::Spread::kApart);
  for (std::size_t a = 0; a < apart.size(); ++a) {
    double squares = 0.0;
    for (std::size_t i = 0; i < places.x.size(); ++i) {
      const auto off = static_cast<double>(together[a][i] - apart[a][i]);
      squares += off * off;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(places.x.size())), 0.2);
  }
}

TEST(PlaceSearch, GivesThePowerAloneWithoutRays) {
  const RoomObservation observation = localizer().receive(frames());
  const ArrayObservation& array = observation.arrays[0];
  Places places;
  places.add(kInCupboard, lattice_of(observation));
  ASSERT_FALSE(array.map->place_box(places.box[0], 0)->is_reachable());
  PlaceSearch search(observation, kExponent);
  const auto values = search.log_likelihoods(places.all(), PlaceSearch::Spread::kTogether);
  const std::size_t cell = places.cell(0, lattice_of(observation));
  EXPECT_EQ(values[0][0], static_cast<float>(array.power_log_likelihood_at(cell, kExponent)));
  EXPECT_EQ(values[1][0], 0.0F);
}

TEST(PlaceSearch, PadsWithTheLastValue) {
  const RoomObservation observation = localizer().receive(frames());
  Places places;
  places.add({10.0, 0.0, 1.2}, lattice_of(observation));
  places.add(kTruth, lattice_of(observation));
  ASSERT_EQ(places.box[0], BoxLattice::kNone);
  PlaceSearch search(observation, kExponent);
  const auto values = search.log_likelihoods(places.all(), PlaceSearch::Spread::kTogether);
  for (const std::vector<float>& one : values) {
    ASSERT_EQ(one.size(), 8U);
    EXPECT_EQ(one[0], PlaceSearch::kNotCompared);
    EXPECT_GT(one[1], 0.0F);
    EXPECT_TRUE(std::all_of(one.begin() + 1, one.end(), [&](float v) { return v == one[1]; }));
  }
  EXPECT_EQ(search.boxes(), 1U);
  const auto none = search.log_likelihoods({}, PlaceSearch::Spread::kApart);
  EXPECT_TRUE(none[0].empty());
  EXPECT_EQ(search.boxes(), 0U);
}

// Each place by itself, its rays traced, with the noise of the class.
TEST(PlaceSearch, FollowsTheExactLikelihood) {
  const RoomObservation observation = localizer().receive(frames());
  const Places places = cloud(lattice_of(observation), 300, 0.1);
  PlaceSearch search(observation, kExponent);
  const auto values = search.log_likelihoods(places.all(), PlaceSearch::Spread::kApart);
  const ArrayObservation& array = observation.arrays[1];  // without a received power
  const ObservationModel model(localizer().room().grid, array.map->antennas());
  const auto offsets = offsets_of(array.map->access_point().array);
  ModelError error = array.map->access_point().error;
  const DelayRows rows = delay_rows(array.observed.array, array.h.size());
  error.noise +=
      noise_of_class(noise_class_of(static_cast<double>(rows.noise), error.noise), error.noise);
  ObservedArray observed = array.observed.array;
  observed.noise = 0.0;
  std::array<double, 5> sums{};
  double count = 0.0;
  for (std::size_t i = 0; i < places.x.size(); ++i) {
    const Vec3d at{static_cast<double>(places.x[i]),
                   static_cast<double>(places.y[i]),
                   static_cast<double>(places.z[i])};
    const auto rays = array.map->rays_to(at);
    if (places.box[i] == BoxLattice::kNone || rays.empty()) {
      continue;
    }
    const double exact = ObservationModel::log_likelihood(
        model.place_of_burst({rays, offsets, 0.007, 0.0, 0.014}, error, observed), observed);
    const auto value = static_cast<double>(values[1][i]);
    const std::array<double, 5> terms{exact, value, exact * exact, value * value, exact * value};
    for (std::size_t k = 0; k < 5; ++k) {
      sums[k] += terms[k];
    }
    count += 1.0;
  }
  ASSERT_GT(count, 250.0);
  const double covariance = sums[4] - sums[0] * sums[1] / count;
  const double variance =
      (sums[2] - sums[0] * sums[0] / count) * (sums[3] - sums[1] * sums[1] / count);
  EXPECT_GE(covariance / std::sqrt(variance), 0.97);
}

TEST(PlaceSearch, NeedsALikelihoodOfPlaces) {
  LocalizerOptions options;
  options.likelihood = LikelihoodKind::kCoherent;
  const Localizer other =
      *Localizer::create(std::make_shared<const RoomModel>(make_room()), options);
  EXPECT_FALSE(PlaceSearch::can_search(other.receive(frames())));
}

}  // namespace
}  // namespace rayloc::place_search_test
