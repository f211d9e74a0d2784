#include "engine/likelihood/box/place_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <random>
#include <vector>

#include "engine/likelihood/nearby_likelihood.h"
#include "engine/room/ray_at_height.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::place_kernel_test {
namespace {

using Value = std::complex<double>;

const Vec3d kTruth{0.4, -0.5, 1.2};
const Vec3d kHalf{0.05, 0.05, 0.15};

// Tones from -last to last.
OfdmGrid grid_to(int last) {
  OfdmGrid grid = test::make_room().grid;
  grid.tone_index.clear();
  for (int k = -last; k <= last; k += 2) {
    if (k != 0) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}

// A row of antennas at the first access point of the room.
AntennaArray row_of(const RoomModel& room, std::size_t antennas) {
  AntennaArray array = room.access_points[0].array;
  array.element_offset.clear();
  for (std::size_t m = 0; m < antennas; ++m) {
    array.element_offset.push_back(
        {0.0, 0.089 * (static_cast<double>(m) - 0.5 * static_cast<double>(antennas - 1)), 0.0});
  }
  return array;
}

// One access point of the synthetic room, modelled well, and a burst of a device.
struct Link {
  RoomModel room = test::make_room();
  PathTracer tracer{room.scene, room.trace};
  AntennaArray array;
  ObservationModel model;
  std::vector<Vec3d> offsets;
  ModelError error;
  double cell_height = 0.014;  // [m]

  Link(AntennaArray of, const OfdmGrid& grid)
      : array(std::move(of)), model(grid, array.element_offset.size()), offsets(offsets_of(array)) {
    error.plan_tolerance = 0.002;
    error.diffuse = 0.01;
    error.noise = 1e-3;
  }
  Link() : Link(row_of(test::make_room(), 3), grid_to(58)) {}

  std::vector<Ray> rays(const Vec3d& position) const {
    return test::rays_to(tracer, room, array, position);
  }
  ObservationModel::Place place(std::span<const Ray> rays) const {
    return {rays, offsets, 0.007, 0.0, cell_height};
  }
  // The burst of these rays with a noise, as a share of the power within the basis.
  ObservedArray received(std::span<const Ray> rays, double noise) const {
    auto h = model.expected({rays, offsets, 0.0}, error);
    double power = 0.0;
    for (const Value& v : h) {
      power += std::norm(v);
    }
    std::mt19937 random(3);
    std::normal_distribution<double> normal(
        0.0, std::sqrt(0.5 * noise * power / static_cast<double>(model.dimension())));
    for (Value& v : h) {
      const double real = normal(random);
      v += Value(real, normal(random));
    }
    ObservedArray observed = model.observe(h);
    observed.noise = noise;
    return observed;
  }
  PlaceBox box(std::span<const Ray> rays, double noise, std::size_t most = kBoxRays) const {
    ModelError all = error;
    all.noise += noise;
    return place_box(model, place(rays), all, {{}, kHalf}, most);
  }
  DelayRows rows(const ObservedArray& observed) const {
    return delay_rows(observed, 2 * model.dimension());
  }
};

struct Places {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;

  void add(const Vec3d& at) {
    x.push_back(static_cast<float>(at.x));
    y.push_back(static_cast<float>(at.y));
    z.push_back(static_cast<float>(at.z));
  }
  BoxPlaces all() const { return {x, y, z}; }
};

// Places all over a box, the first in its middle, then its corners.
Places places_in_box(std::size_t count) {
  Places places;
  places.add({});
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        places.add({x * kHalf.x, y * kHalf.y, z * kHalf.z});
      }
    }
  }
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  while (places.x.size() < count) {
    const double x = uniform(random);
    const double y = uniform(random);
    places.add({x * kHalf.x, y * kHalf.y, uniform(random) * kHalf.z});
  }
  return places;
}

std::vector<float> values_of(const PlaceBox& box, const DelayRows& rows, const BoxPlaces& places) {
  BoxBurst burst;
  whiten_delays_of_box(box, rows, {}, burst);
  std::vector<float> values(places.x.size());
  evaluate_places_of_box(box, burst, places, values);
  return values;
}

std::unique_ptr<const NearbyLikelihood> nearby(const Link& link,
                                               std::span<const Ray> rays,
                                               const ObservedArray& observed) {
  const auto place = link.place(rays);
  return std::make_unique<const NearbyLikelihood>(
      link.model,
      place,
      link.error,
      std::make_unique<const PlaceModel>(link.model.place_of_burst(place, link.error, observed)),
      observed);
}

// Nearby lengths are exact, and its delays are the same ones.
TEST(PlaceKernel, IsTheNearbyLikelihoodInTheMiddle) {
  const RoomModel room = test::make_room();
  for (const int last : {28, 58, 122}) {
    for (const std::size_t antennas : {2U, 3U, 4U}) {
      Link link(row_of(room, antennas), grid_to(last));
      const std::vector<Ray> rays = link.rays(kTruth);
      for (const int noise_class : {0, 4}) {
        for (const double cell_height : {0.0, 0.014}) {
          link.cell_height = cell_height;
          const double noise = noise_of_class(noise_class, link.error.noise);
          const ObservedArray observed =
              link.received(link.rays(kTruth + Vec3d{0.01, -0.005, 0.01}), noise);
          const PlaceBox box = link.box(rays, noise, kMaxBoxRays);
          const Places middle = places_in_box(1);
          const auto values = values_of(box, link.rows(observed), middle.all());
          EXPECT_NEAR(
              static_cast<double>(values[0]), nearby(link, rays, observed)->at({}).value, 0.05)
              << last << ' ' << antennas << ' ' << noise_class << ' ' << cell_height;
        }
      }
    }
  }
}

TEST(PlaceKernel, AntennasAreExactToHalfANatAtTheCorner) {
  Link link;
  const std::vector<Ray> rays = link.rays(kTruth);
  const ObservedArray observed = link.received(rays, 1e-3);
  // As if all corners were close: to first order.
  ModelError error = link.error;
  error.noise += 1e-3;
  const PlaceBox box = place_box(link.model, link.place(rays), error, {}, kMaxBoxRays);
  ASSERT_FALSE(box.has_wide_slopes);
  const auto exact = nearby(link, rays, observed);
  const Places corners = places_in_box(9);
  const auto values = values_of(box, link.rows(observed), corners.all());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(values[i]),
                exact->at({corners.x[i], corners.y[i], corners.z[i]}).value,
                0.5)
        << i;
  }
}

TEST(PlaceKernel, CloseAntennasAreExactAtTheCorner) {
  AntennaArray array = row_of(test::make_room(), 3);
  array.pose.position = kTruth + Vec3d{-0.6, 0.0, 0.0};
  const Link link(array, grid_to(58));
  const std::vector<Ray> rays = link.rays(kTruth);
  const ObservedArray observed = link.received(rays, 1e-3);
  const PlaceBox box = link.box(rays, 1e-3, kMaxBoxRays);
  ASSERT_TRUE(box.has_wide_slopes);
  const auto exact = nearby(link, rays, observed);
  const Places corners = places_in_box(9);
  const auto values = values_of(box, link.rows(observed), corners.all());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(values[i]),
                exact->at({corners.x[i], corners.y[i], corners.z[i]}).value,
                0.5)
        << i;
  }
}

// Sums of pairs of values.
struct Pairs {
  double count = 0.0;
  double a = 0.0;
  double b = 0.0;
  double a_square = 0.0;
  double b_square = 0.0;
  double product = 0.0;

  void add(double of_a, double of_b) {
    count += 1.0;
    a += of_a;
    b += of_b;
    a_square += of_a * of_a;
    b_square += of_b * of_b;
    product += of_a * of_b;
  }
  double variance_a() const { return a_square / count - a * a / count / count; }
  double variance_b() const { return b_square / count - b * b / count / count; }
  double covariance() const { return product / count - a * b / count / count; }
};

// Against each place by itself, its rays traced.
TEST(PlaceKernel, FollowsTheExactLikelihood) {
  const Link link;
  const double noise = 1e-3;
  const Vec3d truth = kTruth + Vec3d{0.013, -0.021, 0.04};
  const ObservedArray observed = link.received(link.rays(truth), noise);
  ModelError error = link.error;
  error.noise += noise;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Pairs pairs;
  for (int i = 0; i < 75; ++i) {
    const int x = i % 5 - 2;
    const int y = i / 5 % 5 - 2;
    const int z = i / 25 - 1;
    const Vec3d middle = kTruth + Vec3d{0.1 * x, 0.1 * y, 0.3 * z};
    const Vec3d cell{middle.x - 0.025, middle.y - 0.025, kTruth.z};
    const auto rays =
        rays_at_height(link.rays(cell), middle.z - cell.z, link.room.device, link.array);
    const PlaceBox box =
        place_box(link.model, link.place(rays), error, {{0.025, 0.025, 0.0}, kHalf}, kBoxRays);
    Places places;
    std::vector<double> exact;
    for (int n = 0; n < 40; ++n) {
      const double dx = kHalf.x * uniform(random);
      const double dy = kHalf.y * uniform(random);
      const Vec3d at{dx, dy, kHalf.z * uniform(random)};
      if (norm(middle + at - truth) < 0.3) {
        places.add(at);
        const auto traced = link.rays(middle + at);
        exact.push_back(ObservationModel::log_likelihood(
            link.model.place_of_burst(link.place(traced), link.error, observed), observed));
      }
    }
    const auto values = values_of(box, link.rows(observed), places.all());
    for (std::size_t n = 0; n < values.size(); ++n) {
      pairs.add(exact[n], static_cast<double>(values[n]));
    }
  }
  ASSERT_GT(pairs.count, 1000.0);
  EXPECT_GE(pairs.covariance(), 0.97 * std::sqrt(pairs.variance_a() * pairs.variance_b()));
  const double of_difference = pairs.variance_a() + pairs.variance_b() - 2.0 * pairs.covariance();
  EXPECT_LT(std::sqrt(of_difference), 0.25 * std::sqrt(pairs.variance_a()));
}

TEST(PlaceKernel, TheObstructedCaseIsTheLargerOne) {
  const Link link;
  const std::vector<Ray> rays = link.rays(kTruth);
  std::vector<Ray> reflected = rays;
  std::erase_if(reflected, [](const Ray& ray) { return ray.reflections == 0; });
  ASSERT_EQ(reflected.size() + 1, rays.size());
  const Places places = places_in_box(20);
  const PlaceBox box = link.box(rays, 1e-3);
  ASSERT_TRUE(box.has_direct);
  PlaceBox clear = box;
  clear.has_direct = false;
  // Without the ray of the line of sight, everything else as in the box.
  PlaceBox obstructed = clear;
  std::fill_n(obstructed.mean(0), 2 * box.size().coordinates, 0.0F);
  for (const bool is_obstructed : {false, true}) {
    const DelayRows rows = link.rows(link.received(is_obstructed ? reflected : rays, 1e-3));
    BoxBurst burst;
    whiten_delays_of_box(box, rows, {}, burst);
    std::vector<float> open(20);
    std::vector<float> without(20);
    std::vector<float> both(20);
    evaluate_places_of_box(clear, burst, places.all(), open);
    evaluate_places_of_box(obstructed, burst, places.all(), without);
    evaluate_places_of_box(box, burst, places.all(), both);
    for (std::size_t i = 0; i < both.size(); ++i) {
      EXPECT_GE(both[i], open[i]);
      const float other = without[i] + static_cast<float>(kLogObstructed);
      EXPECT_NEAR(both[i], std::max(open[i], other), 0.01F) << i;
    }
    // In the middle the burst is that of the model.
    EXPECT_EQ(both[0] > open[0], is_obstructed);
  }
}

TEST(PlaceKernel, AnyNumberOfPlaces) {
  const Link link;
  const std::vector<Ray> rays = link.rays(kTruth);
  const DelayRows rows = link.rows(link.received(rays, 1e-3));
  const PlaceBox box = link.box(rays, 1e-3);
  BoxBurst burst;
  whiten_delays_of_box(box, rows, {}, burst);
  const Places places = places_in_box(17);
  std::vector<float> one_by_one(17);
  for (std::size_t i = 0; i < 17; ++i) {
    const BoxPlaces one{std::span(places.x).subspan(i, 1),
                        std::span(places.y).subspan(i, 1),
                        std::span(places.z).subspan(i, 1)};
    evaluate_places_of_box(box, burst, one, std::span(one_by_one).subspan(i, 1));
  }
  for (std::size_t count = 1; count <= 17; ++count) {
    const BoxPlaces some{std::span(places.x).first(count),
                         std::span(places.y).first(count),
                         std::span(places.z).first(count)};
    std::vector<float> values(count);
    evaluate_places_of_box(box, burst, some, values);
    EXPECT_TRUE(std::equal(values.begin(), values.end(), one_by_one.begin())) << count;
  }
  evaluate_places_of_box(box, burst, {}, {});
}

// Boxes up to a meter from the truth: delays are relative to the first ray of each.
TEST(PlaceKernel, TheHintFindsTheDelayOfTheWholeSearch) {
  const Link link;
  const double noise = 1e-3;
  const ObservedArray observed = link.received(link.rays(kTruth), noise);
  const DelayRows rows = link.rows(observed);
  BoxBurst burst;
  whiten_delays_of_box(link.box(link.rays(kTruth), noise), rows, {}, burst);
  const std::size_t hint = burst.delay;
  int boxes = 0;
  int equal = 0;
  for (int x = -10; x <= 10; ++x) {
    for (int y = -6; y <= 10; ++y) {
      const Vec3d at = kTruth + Vec3d{0.1 * x, 0.1 * y, 0.0};
      if (norm(at - kTruth) > 1.0) {
        continue;
      }
      const PlaceBox box = link.box(link.rays(at), noise);
      BoxBurst by_hint;
      whiten_delays_of_box(box, rows, {}, burst);
      whiten_delays_of_box(box, rows, hint, by_hint);
      ++boxes;
      equal += by_hint.delay == burst.delay ? 1 : 0;
    }
  }
  ASSERT_GT(boxes, 200);
  EXPECT_GE(equal, 0.98 * boxes);
}

TEST(PlaceKernel, KeepsThreeDelaysAtTheEndsOfTheSearch) {
  const Link link;
  const std::vector<Ray> rays = link.rays(kTruth);
  const PlaceBox box = link.box(rays, 1e-3);
  const DelayRows rows = link.rows(link.received(rays, 1e-3));
  for (const bool is_last : {false, true}) {
    // The same array at every delay: the least power has the largest likelihood of a unit gain.
    DelayRows end = rows;
    for (std::size_t i = 0; i < end.coordinates(); ++i) {
      for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
        const std::size_t from = is_last ? ObservedArray::kDelays - 1 - t : t;
        const float scale = 1.0F + static_cast<float>(from);
        end.re[i][t] = rows.re[i][8] * scale;
        end.im[i][t] = rows.im[i][8] * scale;
      }
    }
    BoxBurst burst;
    whiten_delays_of_box(box, end, {}, burst);
    EXPECT_EQ(burst.delay, is_last ? ObservedArray::kDelays - 1 : 0U);
    EXPECT_NEAR(burst.power[1] / burst.power[is_last ? 2 : 0], 4.0F, 1e-3F);
    EXPECT_NEAR(burst.power[is_last ? 0 : 2] / burst.power[is_last ? 2 : 0], 9.0F, 1e-3F);
  }
}

// Every kind of processor whose code runs on this one.
class PlaceKernelTargets : public ::testing::Test {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(PlaceKernelTargets, EveryKindOfProcessor) {
  const Link link;
  const std::vector<Ray> rays = link.rays(kTruth);
  const DelayRows rows = link.rows(link.received(rays, 1e-3));
  const PlaceBox box = link.box(rays, 1e-3);
  const Places places = places_in_box(19);
  const std::vector<float> values = values_of(box, rows, places.all());
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), 2U);
  for (const std::int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    const std::vector<float> other = values_of(box, rows, places.all());
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_NEAR(other[i], values[i], 1e-3F) << i;
    }
  }
}

}  // namespace
}  // namespace rayloc::place_kernel_test
