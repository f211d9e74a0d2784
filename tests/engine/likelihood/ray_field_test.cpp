#include "engine/likelihood/ray_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::ray_field_test {
namespace {

using Value = std::complex<double>;

const Vec3d kMiddle{0.4, -0.5, 1.2};

class RayFields : public ::testing::Test {
 protected:
  RayFields()
      : room_(test::make_room()),
        tracer_(room_.scene, room_.trace),
        model_(room_.grid, 3),
        offsets_(offsets_of(array())) {
    error_.plan_tolerance = 0.002;
    error_.diffuse = 0.01;
    error_.noise = 1e-3;
    lattice_.plan = {7, 8, 0.007, 0.006};
    for (int i = -2; i <= 2; ++i) {
      lattice_.heights.push_back(0.014 * i);
    }
  }

  const AntennaArray& array() const { return room_.access_points[0].array; }

  std::vector<Ray> rays(const Vec3d& position) const {
    return test::rays_to(tracer_, room_, array(), position);
  }
  ObservationModel::Place place(std::span<const Ray> rays) const {
    return {rays, offsets_, 0.0, 0.0, 0.0};
  }

  // With noise of this share of the power within the basis.
  ObservedArray received_from(const Vec3d& position, double noise) const {
    auto h = model_.expected({rays(position), offsets_, 0.0}, error_);
    double power = 0.0;
    for (const Value& v : h) {
      power += std::norm(v);
    }
    std::mt19937 random(3);
    std::normal_distribution<double> normal(
        0.0, std::sqrt(0.5 * noise * power / static_cast<double>(model_.dimension())));
    for (Value& v : h) {
      const double real = normal(random);
      v += Value(real, normal(random));
    }
    ObservedArray observed = model_.observe(h);
    observed.noise = noise;
    return observed;
  }

  // [z][x][y], of all places.
  std::vector<LaneRow> all_places(const RayField& field, const FieldTerms& terms) const {
    std::vector<FieldRow> rows;
    for (std::size_t z = 0; z < lattice_.heights.size(); ++z) {
      for (std::size_t x = 0; x < lattice_.plan.count_x; ++x) {
        rows.push_back(field.row(x, 0, z));
      }
    }
    std::vector<LaneRow> values(rows.size());
    field_rows(terms, terms.delays, rows, values);
    return values;
  }

  RoomModel room_;
  PathTracer tracer_;
  ObservationModel model_;
  ModelError error_;
  std::vector<Vec3d> offsets_;
  FieldLattice lattice_;
};

// Against the model of every place by itself, its rays traced and its covariance factorised with
// the burst's noise: what a field leaves out is far less than what one place has above the next.
TEST_F(RayFields, AreTheLikelihoodOfEveryPlace) {
  const std::vector<Ray> middle = rays(kMiddle);
  const FieldCovariance covariance = field_covariance(model_, place(middle), error_);
  const RayField field = ray_field(model_, covariance, place(middle), error_, lattice_);
  for (const double noise : {0.0, 1e-3, 1e-2}) {
    const ObservedArray observed = received_from(kMiddle + Vec3d{0.01, -0.005, 0.01}, noise);
    FieldBurst burst(covariance, observed, error_.noise + noise);
    const std::vector<LaneRow> values = all_places(field, burst.terms(field));
    double square = 0.0;
    double variance = 0.0;
    double mean = 0.0;
    std::vector<double> exact;
    for (std::size_t z = 0; z < lattice_.heights.size(); ++z) {
      for (std::size_t x = 0; x < lattice_.plan.count_x; ++x) {
        for (std::size_t y = 0; y < lattice_.plan.count_y; ++y) {
          const Vec3d at =
              kMiddle + lattice_.plan.offset(x, y) + Vec3d{0.0, 0.0, lattice_.heights[z]};
          const std::vector<Ray> traced = rays(at);
          exact.push_back(ObservationModel::log_likelihood(
              model_.place_of_burst(place(traced), error_, observed), observed));
          const auto value = static_cast<double>(values[z * lattice_.plan.count_x + x][y]);
          square += (value - exact.back()) * (value - exact.back());
          mean += exact.back();
        }
      }
    }
    const auto count = static_cast<double>(exact.size());
    for (const double one : exact) {
      variance += (one - mean / count) * (one - mean / count);
    }
    EXPECT_LT(std::sqrt(square / count), 0.2 * std::sqrt(variance / count)) << noise;
  }
}

// Single precision and the sums by rays, beside the same model in double precision.
TEST_F(RayFields, AreExactInTheMiddle) {
  const std::vector<Ray> middle = rays(kMiddle);
  const FieldCovariance covariance = field_covariance(model_, place(middle), error_);
  FieldLattice one;
  one.plan = {1, 8, 0.007, 0.0};
  one.heights = {0.0};
  const RayField field = ray_field(model_, covariance, place(middle), error_, one);
  std::vector<Ray> known;  // as many as a field holds
  for (const std::size_t p : covariance.known) {
    known.push_back(middle[p]);
  }
  ASSERT_GT(known.size(), kLaneCount + 1);
  for (const std::size_t count : {kLaneCount - 1, kLaneCount, kLaneCount + 1, known.size()}) {
    const std::span<const Ray> strongest(known.data(), count);
    const FieldCovariance of_known = field_covariance(model_, place(strongest), error_);
    const RayField field_of_known = ray_field(model_, of_known, place(strongest), error_, one);
    EXPECT_EQ(field_of_known.rays, count);
    for (const double noise : {0.0, 1e-2}) {
      const ObservedArray observed = received_from(kMiddle, noise);
      FieldBurst burst(of_known, observed, error_.noise + noise);
      LaneRow value;
      const FieldRow row = field_of_known.row(0, 0, 0);
      const FieldTerms terms = burst.terms(field_of_known);
      field_rows(terms, terms.delays, {&row, 1}, {&value, 1});
      const double exact = ObservationModel::log_likelihood(
          model_.place_of_burst(place(strongest), error_, observed), observed);
      EXPECT_NEAR(static_cast<double>(value[0]), exact, 0.5) << count << " rays, " << noise;
      EXPECT_EQ(value[0], value[7]);
    }
  }
}

// Thousands of them are kept.
TEST_F(RayFields, TakeTheMemoryOfTheirRays) {
  const std::vector<Ray> middle = rays(kMiddle);
  const std::span<const Ray> strongest(middle.data(), 5);
  const FieldCovariance covariance = field_covariance(model_, place(strongest), error_);
  const std::size_t size = model_.dimension();
  EXPECT_EQ(covariance.turn.capacity(), size * size);
  EXPECT_EQ(covariance.diagonal.capacity(), size);
  EXPECT_EQ(covariance.beside.capacity(), size);
  const RayField field = ray_field(model_, covariance, place(strongest), error_, lattice_);
  EXPECT_EQ(field.known.capacity(), size);
  EXPECT_EQ(field.by_x.capacity(), lattice_.plan.count_x);
  EXPECT_EQ(field.by_z.capacity(), lattice_.heights.size());
}

}  // namespace
}  // namespace rayloc::ray_field_test
