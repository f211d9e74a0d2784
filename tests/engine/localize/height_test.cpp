#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>

#include "engine/localize/localizer.h"
#include "engine/room/ray_at_height.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::height_test {
namespace {

constexpr double kSigma = 0.3;

// Calibrated, and with its access points near the ceiling: beside them a device as far above as
// below looks alike.
RoomModel room_of_unknown_heights() {
  RoomModel room = test::make_room();
  room.device.height_sigma = kSigma;
  for (RoomAccessPoint& ap : room.access_points) {
    ap.array.pose.position.z = 2.2;
    ap.error.plan_tolerance = 0.002;
    ap.error.diffuse = 0.01;
  }
  return room;
}

const Localizer& localizer() {
  static const Localizer kLocalizer =
      *Localizer::create(std::make_shared<const RoomModel>(room_of_unknown_heights()), {});
  return kLocalizer;
}

// The tracer's rays from the raised place, ray by ray.
TEST(RaisedRay, IsTheTracersRayFromThere) {
  const RoomModel room = test::make_room();
  const PathTracer tracer(room.scene, room.trace);
  const AntennaArray& array = room.access_points[0].array;
  const Vec3d place{0.4, 0.3, 1.2};
  const auto rays = test::rays_to(tracer, room, array, place);
  for (const double by : {0.3, -0.4}) {
    const auto raised = rays_at_height(rays, by, room.device, array);
    const auto traced = test::rays_to(tracer, room, array, place + Vec3d{0.0, 0.0, by});
    std::size_t same = 0;
    for (const Ray& ray : raised) {
      for (const Ray& other : traced) {
        if (std::abs(ray.length - other.length) < 1e-9 &&
            norm(ray.at_device - other.at_device) < 1e-9) {
          ++same;
          EXPECT_LT(norm(ray.at_array - other.at_array), 1e-6);
          const double ratio = std::abs(ray.amplitude) / std::abs(other.amplitude);
          if (ray.reflections == 0) {
            EXPECT_NEAR(ratio, 1.0, 1e-6);
          } else {  // reflection coefficients are those of the old angles
            EXPECT_GT(ratio, 0.3);
            EXPECT_LT(ratio, 3.0);
          }
        }
      }
    }
    // An empty box: every ray is there from everywhere, but for those beyond the strongest.
    EXPECT_GE(same + 6, std::min(raised.size(), traced.size()));
  }
}

Eigen::MatrixXcd covariance_of(const PlaceModel& place) {
  const auto size = static_cast<Eigen::Index>(place.mean.size() / 2);
  Eigen::MatrixXcd whitener = Eigen::MatrixXcd::Zero(size, size);
  std::size_t at = 0;
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      whitener(i, j) = std::complex<double>(place.whitener[at++]);
    }
  }
  return (whitener.adjoint() * whitener).inverse();
}
Eigen::VectorXcd mean_of(const PlaceModel& place, const Eigen::MatrixXcd& covariance) {
  const Eigen::Index size = covariance.rows();
  Eigen::VectorXcd mean(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    mean(i) = std::complex<double>(place.mean[static_cast<std::size_t>(i)]);
  }
  // W mu, with W = L^-1 of the covariance.
  return Eigen::LLT<Eigen::MatrixXcd>(covariance).matrixL() * mean;
}

// The first two moments of a mixture of Gaussians.
TEST(ObservationModelColumn, IsTheMixtureOfItsHeights) {
  const RoomModel room = test::make_room();
  const RoomAccessPoint& ap = room.access_points[0];
  const auto offsets = offsets_of(ap.array);
  const ObservationModel model(room.grid, 3);
  const auto rays =
      test::rays_to(PathTracer(room.scene, room.trace), room, ap.array, {0.4, 0.3, 1.2});
  const auto high = rays_at_height(rays, 0.2, room.device, ap.array);
  const std::array heights{ObservationModel::WeightedPlace{{rays, offsets, 0.0}, 0.3},
                           ObservationModel::WeightedPlace{{high, offsets, 0.0}, 0.7}};
  const Eigen::MatrixXcd together = covariance_of(model.column(heights, ap.error));
  Eigen::MatrixXcd expected = Eigen::MatrixXcd::Zero(together.rows(), together.cols());
  Eigen::VectorXcd mean = Eigen::VectorXcd::Zero(together.rows());
  for (const auto& [place, weight] : heights) {
    const PlaceModel one = model.place(place, ap.error);
    const Eigen::MatrixXcd covariance = covariance_of(one);
    const Eigen::VectorXcd mu = mean_of(one, covariance);
    expected += weight * (covariance + mu * mu.adjoint());
    mean += weight * mu;
  }
  expected -= mean * mean.adjoint();
  EXPECT_LT((together - expected).norm(), 1e-3 * expected.norm());
}

TEST(UnknownHeight, IsFoundWithThePlace) {
  for (const Vec3d truth : {Vec3d{0.3, 0.2, 1.45}, Vec3d{-0.9, -0.6, 0.9}, Vec3d{0.9, -0.4, 1.2}}) {
    const auto frames = test::frames_at(localizer().room(), truth);
    const LocationEstimate estimate = localizer().locate(frames);
    ASSERT_TRUE(estimate.position) << estimate.reason;
    EXPECT_LT(std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y), 0.1);
    EXPECT_NEAR(estimate.position->z, truth.z, 0.1);
    EXPECT_TRUE(estimate.is_height_estimated);
    const double sigma = std::sqrt(estimate.covariance[8]);
    EXPECT_LT(std::abs(estimate.position->z - truth.z), 4.0 * sigma);
    EXPECT_EQ(estimate.covariance[2], estimate.covariance[6]);
    EXPECT_EQ(estimate.covariance[5], estimate.covariance[7]);
  }
}

TEST(UnknownHeight, IsTheSameOnOneThreadAndOnTwo) {
  const auto frames = test::frames_at(localizer().room(), {0.3, 0.2, 1.4});
  const LocationEstimate two = localizer().locate(frames);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Localizer alone =
      *Localizer::create(std::make_shared<const RoomModel>(room_of_unknown_heights()), {});
  const LocationEstimate estimate = alone.locate(frames);
  EXPECT_EQ(estimate.position, two.position);
  EXPECT_EQ(estimate.covariance, two.covariance);
}

// Also with the likelihoods that do not distinguish places.
TEST(UnknownHeight, IsHandledByEveryLikelihood) {
  const Vec3d truth{0.3, 0.2, 1.4};
  const auto room = std::make_shared<const RoomModel>(room_of_unknown_heights());
  const auto frames = test::frames_at(*room, truth);
  for (const LikelihoodName& one : likelihood_names()) {
    LocalizerOptions options;
    options.likelihood = one.kind;
    const auto other = Localizer::create(room, options);
    ASSERT_TRUE(other);
    const LocationEstimate estimate = other->locate(frames);
    EXPECT_TRUE(estimate.position) << one.name << ": " << estimate.reason;
  }
}

TEST(UnknownHeight, EvidenceSeparatesLayersAndRespectsTheFocus) {
  const auto frames = test::frames_at(localizer().room(), {0.3, 0.2, 1.45});
  const RoomObservation observation = localizer().receive(frames);
  const auto free = localizer().evidence(observation, Localizer::Scan::kPlaces);
  ASSERT_FALSE(free.within.empty());
  for (const auto& [cell, mass] : free.within) {
    ASSERT_EQ(mass.layers.size(), localizer().grid().layers.size());
    EXPECT_NEAR(std::accumulate(mass.layers.begin(), mass.layers.end(), 0.0F), 1.0F, 1e-4F);
  }
  SearchFocus focus;
  focus.log_prior.assign(localizer().grid().size(), -100.0);
  focus.log_prior[7] = 0.0;
  focus.layer_weight = localizer().grid().layers.weight;
  const auto only = localizer().evidence(observation, Localizer::Scan::kPlaces, focus);
  ASSERT_EQ(only.within.size(), 1U);
  EXPECT_EQ(only.within.front().first, 7U);
}

// The height that is assumed is no estimate of it.
TEST(UnknownHeight, IsNotClaimedWhereItIsAssumed) {
  const Localizer known =
      *Localizer::create(std::make_shared<const RoomModel>(test::make_room()), {});
  const LocationEstimate estimate = known.locate(test::frames_at(known.room(), {0.3, 0.2, 1.2}));
  ASSERT_TRUE(estimate.position);
  EXPECT_FALSE(estimate.is_height_estimated);
  EXPECT_EQ(estimate.position->z, 1.2);
}

}  // namespace
}  // namespace rayloc::height_test
