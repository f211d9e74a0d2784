// The model of a sample against differences of itself, and against the tones that it represents.
#include "engine/calibrate/joint/sample_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "engine/scene/scene.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::sample_model_test {
namespace {

using Value = std::complex<double>;

// A room whose plan is wrong, so that something is left unexplained.
struct Surveyed {
  test::SurveyedRoom room = test::make_surveyed_room({.points = 12});
  RoomUnknowns unknowns{room.plan, {}};
  SampleModel model{room.plan.grid};
  std::vector<TracedSample> traced;
  std::vector<double> change;  // of each unknown, neither nothing nor the truth
  Vec3d survey{0.002, -0.001, 0.003};

  Surveyed() : change(unknowns.size()) {
    std::vector<SampleSite> sites;
    for (std::size_t p = 0; p < room.points.size(); ++p) {
      sites.push_back({p, 0, room.points[p].position});
    }
    traced = trace_samples(room.plan, unknowns, sites, {.max_depth = 2}).value();
    for (std::size_t i = 0; i < change.size(); ++i) {
      change[i] = 0.05 * unknowns[i].sigma * std::sin(1.0 + static_cast<double>(i));
    }
  }
  ModelPoint at() const { return {change, survey}; }
  const std::vector<Value>& h(std::size_t i) const { return room.points[i].h[0]; }
  MeasuredSample measured(std::size_t i) const { return model.measured(traced[i], at(), h(i)); }
  std::vector<std::uint32_t> all() const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
      result.push_back(i);
    }
    return result;
  }
};

const Surveyed& surveyed() {
  static const Surveyed kSurveyed;
  return kSurveyed;
}

// 2 Re <residual, derivative>: exact although the derivative of the projection is left out
// (Kaufman), because what is left is at right angles to what was taken out.
double slope(const SampleResidual& residual, const Eigen::MatrixXcd& columns, Eigen::Index i) {
  return 2.0 * residual.value.dot(columns.col(i)).real();
}

// The basis is a table of tones that is interpolated, and its derivative by delay leaves the space
// that it spans (1e-4 of the power): so much the differences differ.
constexpr double kTolerance = 1e-3;

TEST(SampleModel, ResidualMatchesTheSlopeOfTheUnexplainedPower) {
  const Surveyed& in = surveyed();
  const auto unknowns = in.all();
  for (std::size_t sample = 0; sample < in.traced.size(); ++sample) {
    const MeasuredSample measured = in.measured(sample);
    const SampleResidual residual =
        in.model.residual(in.traced[sample], measured, in.at(), unknowns);
    // In units of what each unknown may differ by, so that all are comparable.
    double steepest = 0.0;
    std::vector<double> stated;
    std::vector<double> differences;
    for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
      const double sigma = in.unknowns[i].sigma;
      const double step = 1e-3 * sigma;
      const auto left = [&](double by) {
        std::vector<double> change = in.change;
        change[i] += by;
        return in.model.unexplained(in.traced[sample], measured, {change, in.survey});
      };
      differences.push_back((left(step) - left(-step)) / (2.0 * step) * sigma);
      stated.push_back(slope(residual, residual.derivative, static_cast<Eigen::Index>(i)) * sigma);
      steepest = std::max(steepest, std::abs(differences.back()));
    }
    ASSERT_GT(steepest, 1e-3) << sample;
    for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
      EXPECT_NEAR(stated[i], differences[i], kTolerance * steepest)
          << to_string(parameter_id(in.unknowns[i], in.room.plan)) << " of sample " << sample;
    }
  }
}

TEST(SampleModel, ResidualDescribesTheSlopeByTheSurvey) {
  const Surveyed& in = surveyed();
  constexpr double kStep = 1e-5;
  for (std::size_t sample = 0; sample < in.traced.size(); ++sample) {
    const MeasuredSample measured = in.measured(sample);
    const SampleResidual residual = in.model.residual(in.traced[sample], measured, in.at(), {});
    std::vector<double> stated;
    std::vector<double> differences;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3d step{axis == 0 ? kStep : 0.0, axis == 1 ? kStep : 0.0, axis == 2 ? kStep : 0.0};
      const double above =
          in.model.unexplained(in.traced[sample], measured, {in.change, in.survey + step});
      const double below =
          in.model.unexplained(in.traced[sample], measured, {in.change, in.survey - step});
      differences.push_back((above - below) / (2.0 * kStep));
      stated.push_back(slope(residual, residual.by_survey, axis));
    }
    const double steepest =
        std::max({std::abs(differences[0]), std::abs(differences[1]), std::abs(differences[2])});
    ASSERT_GT(steepest, 0.1) << sample;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(stated[axis], differences[axis], kTolerance * steepest) << sample;
    }
  }
}

TEST(SampleModel, ResidualAndUnexplainedAgree) {
  const Surveyed& in = surveyed();
  for (std::size_t sample = 0; sample < in.traced.size(); ++sample) {
    const MeasuredSample measured = in.measured(sample);
    EXPECT_NEAR(in.model.residual(in.traced[sample], measured, in.at(), {}).unexplained(),
                in.model.unexplained(in.traced[sample], measured, in.at()),
                1e-12);
  }
}

// By what is left of the samples.
SampleModel weighed_model(const Surveyed& in) {
  Eigen::MatrixXcd left_over = in.model.nothing_left_over();
  for (std::size_t i = 0; i < in.traced.size(); ++i) {
    in.model.add_left_over(in.traced[i], in.at(), in.h(i), left_over);
  }
  return in.model.weighed(left_over);
}

// The largest share of the unexplained power in one direction of the space of the coordinates.
double largest_share(const Eigen::MatrixXcd& left_over) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> eigen(left_over, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().sum();
}

// A device within a metal cabinet: its frames are received, and the plan has no path to it.
TEST(SampleModel, WithoutRaysEverythingIsUnexplained) {
  const Surveyed& in = surveyed();
  TracedSample shut = in.traced[0];
  for (auto& rays : shut.rays) {
    rays.clear();
  }
  const MeasuredSample measured = in.model.measured(shut, in.at(), in.h(0));
  EXPECT_GT(measured.y.norm(), 0.0);
  const auto unknowns = in.all();
  const SampleResidual residual = in.model.residual(shut, measured, in.at(), unknowns);
  EXPECT_EQ(residual.value, measured.y);
  EXPECT_EQ(residual.derivative.norm(), 0.0);
  EXPECT_EQ(residual.by_survey.norm(), 0.0);
  EXPECT_EQ(in.model.unexplained(shut, measured, in.at()), measured.y.squaredNorm());
}

TEST(SampleModel, WeighsCoordinatesByTheirResiduals) {
  const Surveyed& in = surveyed();
  const Eigen::Index q = in.model.nothing_left_over().rows();
  const SampleModel same = in.model.weighed(3.0 * Eigen::MatrixXcd::Identity(q, q));
  const SampleModel weighed = weighed_model(in);
  Eigen::MatrixXcd plain_left = in.model.nothing_left_over();
  Eigen::MatrixXcd weighed_left = in.model.nothing_left_over();
  for (std::size_t i = 0; i < in.traced.size(); ++i) {
    const double plain = in.model.unexplained(in.traced[i], in.measured(i), in.at());
    EXPECT_NEAR(
        same.unexplained(in.traced[i], same.measured(in.traced[i], in.at(), in.h(i)), in.at()),
        plain,
        1e-6);
    in.model.add_left_over(in.traced[i], in.at(), in.h(i), plain_left);
    weighed.add_left_over(in.traced[i], in.at(), in.h(i), weighed_left);
  }
  EXPECT_LT(largest_share(weighed_left), 0.7 * largest_share(plain_left));
}

TEST(SampleModel, ResidualOfAWeighedModelDescribesItsSlope) {
  const Surveyed& in = surveyed();
  const SampleModel model = weighed_model(in);
  const auto unknowns = in.all();
  const MeasuredSample measured = model.measured(in.traced[0], in.at(), in.h(0));
  const SampleResidual residual = model.residual(in.traced[0], measured, in.at(), unknowns);
  double steepest = 0.0;
  std::vector<double> off;
  for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
    const double sigma = in.unknowns[i].sigma;
    const double step = 1e-3 * sigma;
    const auto left = [&](double by) {
      std::vector<double> change = in.change;
      change[i] += by;
      return model.unexplained(in.traced[0], measured, {change, in.survey});
    };
    const double difference = (left(step) - left(-step)) / (2.0 * step) * sigma;
    off.push_back(std::abs(
        slope(residual, residual.derivative, static_cast<Eigen::Index>(i)) * sigma - difference));
    steepest = std::max(steepest, std::abs(difference));
  }
  ASSERT_GT(steepest, 1e-3);
  EXPECT_LT(*std::max_element(off.begin(), off.end()), kTolerance * steepest);
}

// Everything of a sample that is asked for does not depend on what else is.
TEST(SampleModel, DerivativesOfSomeAreThoseOfAll) {
  const Surveyed& in = surveyed();
  const std::vector<std::uint32_t> some{
      2, in.unknowns.permittivity(0), in.unknowns.array_angle(0), in.unknowns.chain_gain(0, 1) + 1};
  const MeasuredSample measured = in.measured(0);
  const auto all = in.model.residual(in.traced[0], measured, in.at(), in.all());
  const auto few = in.model.residual(in.traced[0], measured, in.at(), some);
  ASSERT_EQ(few.derivative.cols(), 4);
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR((few.derivative.col(i) -
                 all.derivative.col(static_cast<Eigen::Index>(some[static_cast<std::size_t>(i)])))
                    .norm(),
                0.0,
                1e-12);
  }
}

TEST(SampleModel, ScanMatchesTheUnexplainedPowerAtEachValue) {
  const Surveyed& in = surveyed();
  const std::vector<double> values{-0.03, -0.001, 0.0, 0.02, 0.05};
  int scanned = 0;
  for (std::uint32_t unknown = 0; unknown < in.unknowns.size(); ++unknown) {
    const MeasuredSample measured = in.measured(3);
    const auto scan = in.model.scan(in.traced[3], measured, in.at(), unknown, values);
    if (scan.empty()) {
      continue;  // nothing depends on it
    }
    ++scanned;
    ASSERT_EQ(scan.size(), values.size());
    for (std::size_t j = 0; j < values.size(); ++j) {
      std::vector<double> change = in.change;
      change[unknown] = values[j];
      EXPECT_NEAR(scan[j], in.model.unexplained(in.traced[3], measured, {change, in.survey}), 1e-9)
          << to_string(parameter_id(in.unknowns[unknown], in.room.plan)) << " at " << values[j];
    }
  }
  EXPECT_GT(scanned, 20);
}

// The model's coordinates leave out what the basis does not span, of the measured array `outside`.
TEST(SampleModel, UnexplainedPowerComplementsTheCorrelation) {
  const Surveyed& in = surveyed();
  for (std::size_t sample = 0; sample < in.traced.size(); ++sample) {
    const MeasuredSample measured = in.measured(sample);
    const auto expected = in.model.expected_tones(in.traced[sample], in.at());
    const double correlation =
        in.model.aligner().align(in.h(sample), expected).correlation / (1.0 - measured.outside);
    EXPECT_LT(measured.outside, 0.01) << sample;
    EXPECT_NEAR(in.model.unexplained(in.traced[sample], measured, in.at()), 1.0 - correlation, 2e-3)
        << sample;
  }
}

// The expected tones themselves: a sum over rays.
TEST(SampleModel, ExpectsTheSumOfTheRays) {
  const Surveyed& in = surveyed();
  const TracedSample& sample = in.traced[1];
  const std::vector<double> none(in.unknowns.size());
  const auto h = in.model.expected_tones(sample, {none, {}});
  const OfdmGrid& grid = in.room.plan.grid;
  ASSERT_EQ(h.size(), 3 * grid.size());
  for (const std::size_t k : {std::size_t{0}, grid.size() / 2, grid.size() - 1}) {
    Value sum;
    for (const LinearRay& ray : sample.rays[2]) {
      const double frequency = grid.centre_hz + grid.offset_hz(k);
      sum += ray.amplitude * std::polar(1.0, -2.0 * std::numbers::pi * frequency * ray.delay);
    }
    EXPECT_NEAR(std::abs(h[2 * grid.size() + k] - sum), 0.0, 1e-9 * std::abs(sum)) << k;
  }
}

// A burst's own factor and delay are no part of the room.
TEST(SampleModel, AFactorAndADelayOfTheBurstChangeNothing) {
  const Surveyed& in = surveyed();
  auto h = in.h(2);
  in.model.aligner().apply({7e-9, std::polar(3.0, 1.0), 1.0}, h);
  const MeasuredSample other = in.model.measured(in.traced[2], in.at(), h);
  EXPECT_NEAR(in.model.unexplained(in.traced[2], other, in.at()),
              in.model.unexplained(in.traced[2], in.measured(2), in.at()),
              1e-6);
}

}  // namespace
}  // namespace rayloc::sample_model_test
