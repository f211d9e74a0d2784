#include "engine/likelihood/observation_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/observe/alignment.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::observation_model_test {
namespace {

using Value = std::complex<double>;

std::vector<Ray> rays_to(const RoomModel& room, const AntennaArray& array, const Vec3d& position) {
  return test::rays_to(PathTracer(room.scene, room.trace), room, array, position);
}

TEST(DelayBasis, HoldsEveryEchoOfTheWindow) {
  const RoomModel room = test::make_room();
  const DelayBasis basis(room.grid);
  EXPECT_LE(basis.size(), 8U);
  std::vector<Value> s(basis.size());
  for (const double delay : {-10e-9, 0.0, 0.333e-9, 20e-9, 70e-9}) {
    basis.tone(delay, s);
    double power = 0.0;
    for (const Value& v : s) {
      power += std::norm(v);
    }
    EXPECT_NEAR(power, 1.0, 2e-3) << delay;
  }
}

// The rays of the array's centre represent the traces of every element.
TEST(ObservationModel, PredictsTheChannelsOfTheElements) {
  const RoomModel room = test::make_room();
  const RoomAccessPoint& ap = room.access_points[0];
  const Vec3d position{0.4, -0.5, 1.2};
  ModelError exact;
  exact.plan_tolerance = 0.0;
  const auto rays = rays_to(room, ap.array, position);
  const auto offsets = offsets_of(ap.array);
  const ObservationModel model(room.grid, 3);
  const auto expected = model.expected({rays, offsets, 0.0}, exact);
  std::vector<Value> traced;
  const PathTracer tracer(room.scene, room.trace);
  for (const Receiver& element : array_elements<Receiver>(ap.array)) {
    const auto row =
        tracer.trace({{position, {}, room.device.pattern, room.device.polarization}}, element)
            .cfr(room.grid);
    traced.insert(traced.end(), row.begin(), row.end());
  }
  // The difference is that patterns and angles of incidence are those of the centre.
  EXPECT_GT(Aligner(room.grid).align(expected, traced).correlation, 0.999);
}

TEST(ObservationModel, LikelihoodPeaksAtThePlaceForAnyGainPhaseAndDelay) {
  const RoomModel room = test::make_room();
  const RoomAccessPoint& ap = room.access_points[0];
  const auto offsets = offsets_of(ap.array);
  const ObservationModel model(room.grid, 3);
  ModelError error;
  // A room that is modelled well: one access point distinguishes the places.
  error.plan_tolerance = 0.001;
  error.diffuse = 0.005;
  const Vec3d truth{0.4, -0.5, 1.2};
  const auto received = model.expected({rays_to(room, ap.array, truth), offsets, 0.0}, error);
  auto changed = received;
  Aligner(room.grid).apply({-200e-9, Value(0.0, 7.0), 0.0}, changed);
  const auto observed = model.observe(received);
  const auto again = model.observe(changed);
  EXPECT_GT(observed.captured, 0.98);
  const auto at = [&](const Vec3d& p, const ObservedArray& y) {
    const auto rays = rays_to(room, ap.array, p);
    return ObservationModel::log_likelihood(model.place({rays, offsets, 0.05}, error), y);
  };
  const double here = at(truth, observed);
  EXPECT_NEAR(at(truth, again), here, 2.0);
  for (const Vec3d p : {Vec3d{0.4, 0.5, 1.2}, Vec3d{-0.4, -0.5, 1.2}, Vec3d{1.0, -0.9, 1.2}}) {
    EXPECT_GT(here, at(p, observed) + 10.0);
  }
}

TEST(ObservationModel, CoarseLikelihoodIsALowerBoundNearTheFull) {
  const RoomModel room = test::make_room();
  const RoomAccessPoint& ap = room.access_points[1];
  const auto offsets = offsets_of(ap.array);
  const ObservationModel model(room.grid, 3);
  const Vec3d truth{-0.2, 0.3, 1.2};
  const auto rays = rays_to(room, ap.array, truth);
  const PlaceModel place = model.place({rays, offsets, 0.05}, {});
  const auto observed = model.observe(model.expected({rays, offsets, 0.0}, {}));
  const double full = ObservationModel::log_likelihood(place, observed);
  const double coarse = ObservationModel::coarse(place, observed).log_likelihood;
  EXPECT_LE(coarse, full);
  EXPECT_GT(coarse, full - 35.0);
}

// The remaining mean of a ray is the mean of its phase, relative to the first ray's, over the
// places where the point may be: compared with traces to such places.
TEST(ObservationModel, KnownFractionIsTheMeanOverSurveyErrors) {
  const RoomModel room = test::make_room();
  const AntennaArray& array = room.access_points[0].array;
  const Vec3d middle{0.4, -0.5, 1.2};
  constexpr double kSigma = 0.006;
  const auto rays = rays_to(room, array, middle);
  const ObservationModel model(room.grid, 3);
  const auto offsets = offsets_of(array);
  ModelError exact;
  exact.plan_tolerance = 0.0;
  const auto parts = model.ray_terms({rays, offsets, 0.0, kSigma}, exact).parts;
  const auto shortest = [](const std::vector<Ray>& all) {
    return std::min_element(all.begin(),
                            all.end(),
                            [](const Ray& a, const Ray& b) { return a.length < b.length; })
        ->length;
  };
  std::vector<Value> mean(rays.size());
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0.0, kSigma);
  constexpr int kPlaces = 3000;
  for (int n = 0; n < kPlaces; ++n) {
    const Vec3d place{
        middle.x + normal(random), middle.y + normal(random), middle.z + normal(random)};
    const auto moved = rays_to(room, array, place);
    ASSERT_EQ(moved.size(), rays.size());
    const double nearer = shortest(moved) - shortest(rays);
    for (std::size_t p = 0; p < rays.size(); ++p) {
      const auto same =
          std::max_element(moved.begin(), moved.end(), [&](const Ray& a, const Ray& b) {
            return dot(a.at_array, rays[p].at_array) < dot(b.at_array, rays[p].at_array);
          });
      const double change = same->length - rays[p].length - nearer;
      mean[p] += std::polar(1.0, -model.wave_number() * change) / static_cast<double>(kPlaces);
    }
  }
  for (std::size_t p = 0; p < rays.size(); ++p) {
    EXPECT_NEAR(parts[p].known, std::abs(mean[p]), 0.05) << p;
  }
  EXPECT_LT(parts.back().known, 0.9);
}

TEST(ObservationModel, APlaceWithoutRaysIsNotReachable) {
  const RoomModel room = test::make_room();
  const ObservationModel model(room.grid, 3);
  EXPECT_FALSE(model.place({{}, {}, 0.05}, {}).reachable);
}

}  // namespace
}  // namespace rayloc::observation_model_test
