#include "engine/likelihood/likelihood.h"
#include "engine/grid/lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <Eigen/Dense>

#include "engine/observe/alignment.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::likelihood_test {
namespace {

using Value = std::complex<double>;

constexpr double kCell = 0.007;  // [m]: a place, as near as the wavelength asks for

// One access point of the synthetic room, known well.
class Link {
 public:
  Link()
      : room_(test::make_room()), tracer_(room_.scene, room_.trace), offsets_(offsets_of(array())) {
    error_.plan_tolerance = 0.001;
    error_.diffuse = 0.005;
  }

  const RoomModel& room() const { return room_; }
  const ModelError& error() const { return error_; }
  const std::vector<Vec3d>& offsets() const { return offsets_; }

  Transmitter device(const Vec3d& position) const {
    return {{position, {}, room_.device.pattern, room_.device.polarization}};
  }
  Receiver centre() const { return array_origin<Receiver>(array()); }
  std::vector<Ray> rays(const Vec3d& position) const {
    return test::rays_to(tracer_, room_, array(), position);
  }
  // [antenna][tone], every element traced for itself.
  std::vector<Value> channel(const Vec3d& position) const {
    std::vector<Value> h;
    for (const Receiver& element : array_elements<Receiver>(array())) {
      const auto row = tracer_.trace(device(position), element).cfr(room_.grid);
      h.insert(h.end(), row.begin(), row.end());
    }
    return h;
  }
  const PathTracer& tracer() const { return tracer_; }

 private:
  const AntennaArray& array() const { return room_.access_points[0].array; }

  RoomModel room_;
  PathTracer tracer_;
  ModelError error_;
  std::vector<Vec3d> offsets_;
};

const Link& link() {
  static const Link kLink;
  return kLink;
}

const Vec3d kTruth{0.4, -0.5, 1.2};

class EachLikelihood : public ::testing::TestWithParam<LikelihoodName> {
 protected:
  double at(const Vec3d& place, const ObservedBurst& observed) const {
    const auto rays = link().rays(place);
    return likelihood_->log_likelihood(
        likelihood_->place({rays, link().offsets(), kCell}, link().error()), observed);
  }

  std::unique_ptr<const Likelihood> likelihood_ =
      Likelihood::make(GetParam().kind, link().room().grid, 3);
};

INSTANTIATE_TEST_SUITE_P(Kinds,
                         EachLikelihood,
                         ::testing::ValuesIn(likelihood_names().begin(), likelihood_names().end()),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(EachLikelihood, IsHighestWhereTheDeviceIs) {
  const auto observed = likelihood_->observe(link().channel(kTruth));
  const double here = at(kTruth, observed);
  EXPECT_GT(here,
            likelihood_->log_likelihood(likelihood_->null_model(link().error()), observed) + 5.0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-1.4, 1.4);
  std::uniform_real_distribution<double> y(-1.1, 1.1);
  // Directions and delays alone resolve no better.
  const double near = GetParam().kind == LikelihoodKind::kPathCovariance ? 0.4 : 0.1;
  for (int i = 0; i < 200; ++i) {
    const Vec3d other{x(random), y(random), 1.2};
    if (norm(other - kTruth) > near) {
      EXPECT_GT(here, at(other, observed)) << other.x << ' ' << other.y;
    }
  }
}

TEST_P(EachLikelihood, DoesNotSeeGainPhaseAndTiming) {
  const auto received = link().channel(kTruth);
  const auto observed = likelihood_->observe(received);
  for (const double delay : {-200e-9, 33e-9, 350e-9}) {
    auto changed = received;
    Aligner(link().room().grid).apply({delay, std::polar(7.0, 2.0), 0.0}, changed);
    const auto again = likelihood_->observe(changed);
    for (const Vec3d place : {kTruth, Vec3d{-0.3, 0.4, 1.2}}) {
      // The search for the delay has steps of 1.5 ns.
      EXPECT_NEAR(at(place, again), at(place, observed), 2.0);
    }
  }
}

TEST_P(EachLikelihood, CoarseIsALowerBound) {
  const auto observed = likelihood_->observe(link().channel(kTruth));
  for (const Vec3d place : {kTruth, Vec3d{-0.3, 0.4, 1.2}, Vec3d{1.1, 0.2, 1.2}}) {
    const auto rays = link().rays(place);
    const auto of = likelihood_->place({rays, link().offsets(), 0.05}, link().error());
    EXPECT_LE(likelihood_->coarse(of, observed).log_likelihood,
              likelihood_->log_likelihood(of, observed));
  }
}

TEST_P(EachLikelihood, APlaceWithoutRaysIsNotReachable) {
  EXPECT_FALSE(likelihood_->place({{}, {}, kCell}, link().error()).reachable);
}

// mu and Sigma of METHODS B2 written down with dense matrices, of rays with v_p of their power
// unknown, and the likelihood at one delay of the search.
struct Dense {
  Eigen::VectorXcd mu;
  Eigen::MatrixXcd sigma;

  double at(const Eigen::VectorXcd& y) const {
    const Eigen::MatrixXcd inverse = sigma.inverse();
    const auto d = static_cast<double>(y.size());
    const double a = y.dot(inverse * y).real();
    const double b = std::abs(mu.dot(inverse * y));
    const double r = (b + std::sqrt(b * b + 4.0 * a * d)) / (2.0 * a);
    return 2.0 * d * std::log(r) - a * r * r + 2.0 * b * r - mu.dot(inverse * mu).real() -
           std::log(std::abs(sigma.determinant()));
  }
};

Dense dense(const std::vector<Ray>& rays,
            const ModelError& error,
            const std::function<std::pair<double, double>(const Ray&)>& parts) {
  const DelayBasis basis(link().room().grid);
  const auto q = static_cast<Eigen::Index>(basis.size());
  const double k = 2.0 * std::numbers::pi * link().room().grid.centre_hz / 299'792'458.0;
  double power = 0.0;
  double first = rays.front().length;
  for (const Ray& ray : rays) {
    power += std::norm(ray.amplitude);
    first = std::min(first, ray.length);
  }
  Dense result{Eigen::VectorXcd::Zero(3 * q), Eigen::MatrixXcd::Zero(3 * q, 3 * q)};
  std::vector<Value> tone(basis.size());
  for (const Ray& ray : rays) {
    basis.tone((ray.length - first) / 299'792'458.0, tone);
    Eigen::VectorXcd s(3 * q);
    for (Eigen::Index m = 0; m < 3; ++m) {
      const double length =
          norm(ray.length * ray.at_array - link().offsets()[static_cast<std::size_t>(m)]);
      for (Eigen::Index i = 0; i < q; ++i) {
        s(m * q + i) = ray.amplitude * std::polar(1.0 / std::sqrt(3.0 * power), -k * length) *
                       tone[static_cast<std::size_t>(i)];
      }
    }
    const auto [known, unknown] = parts(ray);
    result.mu += known * s;
    result.sigma += unknown * s * s.adjoint();
  }
  const auto diffuse = basis.diffuse_covariance(18e-9);
  for (Eigen::Index m = 0; m < 3; ++m) {
    for (Eigen::Index i = 0; i < q; ++i) {
      for (Eigen::Index j = 0; j < q; ++j) {
        result.sigma(m * q + i, m * q + j) += error.diffuse / 3.0 *
                                              std::pow(first / 3.0, error.diffuse_exponent) *
                                              diffuse[static_cast<std::size_t>(i * q + j)];
      }
      result.sigma(m * q + i, m * q + i) += error.noise / static_cast<double>(3 * q);
    }
  }
  return result;
}

// The best of the delays of the search.
double best_of(const Dense& model, const ObservedArray& observed) {
  double best = -1e300;
  for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
    Eigen::VectorXcd y(model.mu.size());
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      y(i) = observed.value(static_cast<std::size_t>(i), t);
    }
    best = std::max(best, model.at(y));
  }
  return best;
}

// The likelihood, without the search between the delays.
double on_delays(LikelihoodKind kind,
                 const std::vector<Ray>& rays,
                 const ModelError& error,
                 const std::vector<Value>& received) {
  const auto likelihood = Likelihood::make(kind, link().room().grid, 3);
  const auto observed = likelihood->observe(received);
  const auto place = likelihood->place({rays, link().offsets(), 0.0}, error);
  const double found = likelihood->log_likelihood(place, observed);
  double best = -1e300;
  std::vector<Value> y(observed.array.coordinates());
  for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
    // The same at every delay, so that there is nothing to search between.
    ObservedArray one = observed.array;
    for (std::size_t i = 0; i < y.size(); ++i) {
      for (std::size_t other = 0; other < ObservedArray::kDelays; ++other) {
        one.set(i, other, observed.array.value(i, t));
      }
    }
    best = std::max(best, ObservationModel::log_likelihood(place.model, one));
  }
  EXPECT_GE(found, best - 1e-6);
  return best;
}

TEST(Likelihoods, MatchTheirFormulasWithDenseMatrices) {
  const ModelError error = link().error();
  const double k = 2.0 * std::numbers::pi * link().room().grid.centre_hz / 299'792'458.0;
  const auto partial = [&](const Ray& ray) {
    const double sigma = 2.0 * k * error.plan_tolerance;
    const double known = std::exp(-0.5 * sigma * sigma * ray.cos2_incidence);
    const std::array<double, 4> strength{0.02, 0.1, 0.2, 0.3};
    return std::pair(
        known,
        1.0 - known * known + strength[static_cast<std::size_t>(std::min(ray.reflections, 3))]);
  };
  const auto coherent = [](const Ray&) { return std::pair(1.0, 0.0); };
  const auto covariance = [](const Ray&) { return std::pair(0.0, 1.0); };
  const auto received = link().channel(kTruth);
  for (const Vec3d place : {kTruth, Vec3d{-0.3, 0.4, 1.2}}) {
    const auto rays = link().rays(place);
    const auto expect = [&](LikelihoodKind kind, const auto& parts) {
      const auto observed = ObservationModel(link().room().grid, 3).observe(received);
      const double reference = best_of(dense(rays, error, parts), observed);
      // Single precision inside.
      EXPECT_NEAR(on_delays(kind, rays, error, received), reference, 1e-3 * std::abs(reference));
    };
    expect(LikelihoodKind::kCoherent, coherent);
    expect(LikelihoodKind::kPathCovariance, covariance);
    // The better of an open line of sight and one whose mean is absent, one time in fifty.
    const auto obstructed = [&](const Ray& ray) {
      return std::pair(ray.reflections == 0 ? 0.0 : partial(ray).first, partial(ray).second);
    };
    const auto observed = ObservationModel(link().room().grid, 3).observe(received);
    const double reference =
        std::max(best_of(dense(rays, error, partial), observed),
                 std::log(0.02) + best_of(dense(rays, error, obstructed), observed));
    EXPECT_NEAR(on_delays(LikelihoodKind::kPartial, rays, error, received),
                reference,
                1e-3 * std::abs(reference));
  }
}

TEST(Likelihoods, FindAnObstructedDevice) {
  const ObservationModel model(link().room().grid, 3);
  ModelError error;  // a room that is modelled well: reflections distinguish places
  error.plan_tolerance = 0.001;
  error.diffuse = 0.005;
  const auto log_likelihood = [&](const std::vector<Ray>& rays, const ObservedArray& received) {
    return ObservationModel::log_likelihood(model.place({rays, link().offsets(), 0.0}, error),
                                            received);
  };
  const auto rays = link().rays(kTruth);
  std::vector<Ray> reflected;
  for (const Ray& ray : rays) {
    if (ray.reflections > 0) {
      reflected.push_back(ray);
    }
  }
  ASSERT_EQ(reflected.size() + 1, rays.size());
  const auto received = model.observe(model.expected({reflected, link().offsets(), 0.0}, error));
  const auto place = model.place({rays, link().offsets(), 0.0}, error);
  const auto odds = ObservationModel::obstructed_log_odds(place, received);
  ASSERT_TRUE(odds);
  EXPECT_GT(*odds, 5.0);
  const double here = log_likelihood(rays, received);
  for (const Vec3d p : {Vec3d{-0.3, 0.4, 1.2}, Vec3d{0.1, 0.7, 1.2}, Vec3d{0.9, 0.2, 1.2}}) {
    EXPECT_GT(here, log_likelihood(link().rays(p), received) + 5.0);
  }
  // An open access point has the opposite odds, and a place without a line of sight none.
  const auto open = model.observe(model.expected({rays, link().offsets(), 0.0}, error));
  EXPECT_LT(*ObservationModel::obstructed_log_odds(place, open), -5.0);
  EXPECT_FALSE(ObservationModel::obstructed_log_odds(
      model.place({reflected, link().offsets(), 0.0}, error), open));
}

TEST(Likelihoods, PartialHasCoherentAndPathCovarianceAsItsLimits) {
  const auto received = link().channel(kTruth);
  auto rays = link().rays(kTruth);
  ModelError exact = link().error();
  exact.plan_tolerance = 0.0;
  exact.strength = 0.0;
  EXPECT_NEAR(on_delays(LikelihoodKind::kPartial, rays, exact, received),
              on_delays(LikelihoodKind::kCoherent, rays, exact, received),
              1e-6);
  // The line of sight meets no surface, so nothing makes its phase uncertain.
  std::erase_if(rays, [](const Ray& ray) { return ray.reflections == 0; });
  ModelError vague = exact;
  vague.plan_tolerance = 10.0;
  EXPECT_NEAR(on_delays(LikelihoodKind::kPartial, rays, vague, received),
              on_delays(LikelihoodKind::kPathCovariance, rays, vague, received),
              1e-6);
}

TEST(Likelihoods, PathCovarianceDoesNotSeePhasesOfRays) {
  const auto received = link().channel(kTruth);
  auto rays = link().rays(kTruth);
  const auto of = [&](LikelihoodKind kind) {
    return on_delays(kind, rays, link().error(), received);
  };
  const double covariance = of(LikelihoodKind::kPathCovariance);
  const double coherent = of(LikelihoodKind::kCoherent);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  for (Ray& ray : rays) {
    ray.amplitude *= std::polar(1.0, phase(random));
  }
  EXPECT_NEAR(of(LikelihoodKind::kPathCovariance), covariance, 1e-2);
  EXPECT_LT(of(LikelihoodKind::kCoherent), coherent - 10.0);
}

TEST(Ray, ImagesStayWhenTheDeviceMoves) {
  const Vec3d moved{0.02, -0.015, 0.0};
  const auto rays = link().rays(kTruth);
  const Paths paths = link().tracer().trace(link().device(kTruth), link().centre());
  const auto elements = array_elements<Receiver>(link().room().access_points[0].array);
  for (std::size_t m = 0; m < elements.size(); ++m) {
    std::vector<double> traced;
    for (const Path& path : link().tracer().trace(link().device(kTruth + moved), elements[m])) {
      traced.push_back(path.tau * 299'792'458.0);
    }
    for (const Ray& ray : rays) {
      const double length = norm(image_of(ray, link().offsets()[m]) - moved);
      const double nearest =
          std::abs(*std::min_element(traced.begin(), traced.end(), [&](double a, double b) {
            return std::abs(a - length) < std::abs(b - length);
          }) - length);
      EXPECT_LT(nearest, 1e-7) << ray.reflections;
    }
  }
  EXPECT_EQ(paths.size(), rays.size());
}

TEST(Ray, TheStrongestAreKeptWithoutRoomForTheOthers) {
  const Paths paths = link().tracer().at(link().centre()).trace(link().device(kTruth));
  const auto all = rays_of(paths, link().room(), kTruth, paths.size());
  ASSERT_GT(all.size(), 2U);
  const auto two = rays_of(paths, link().room(), kTruth, 2);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two.capacity(), 2U);
  EXPECT_EQ(two[0].length, all[0].length);
  EXPECT_EQ(two[1].length, all[1].length);
}

// The tracer's own derivative of a delay is that of the image.
TEST(Ray, DelayMatchesTheTracerDerivative) {
  const ReceiverTracer tracer = link().tracer().at(link().centre());
  const Paths paths = tracer.trace(link().device(kTruth));
  const auto derivatives = tracer.differentiate(
      link().device(kTruth),
      paths,
      std::array{Parameter::transmitter_position(0), Parameter::transmitter_position(1)});
  ASSERT_TRUE(derivatives);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const auto one = rays_of(Paths({paths[i]}), link().room(), kTruth, 1);
    const Vec3d to_image = image_of(one[0], {});
    EXPECT_NEAR(derivatives->at(i, 0).tau * 299'792'458.0, -to_image.x / norm(to_image), 1e-9);
    EXPECT_NEAR(derivatives->at(i, 1).tau * 299'792'458.0, -to_image.y / norm(to_image), 1e-9);
  }
}

class Nearby : public ::testing::TestWithParam<LikelihoodKind> {
 protected:
  Nearby()
      : likelihood_(Likelihood::make(GetParam(), link().room().grid, 3)),
        observed_(likelihood_->observe(link().channel(kTruth + Vec3d{0.013, 0.006, 0.0}))),
        rays_(link().rays(kTruth)),
        place_(likelihood_->close({rays_, link().offsets(), kCell}, link().error())),
        nearby_(likelihood_->nearby(
            {rays_, link().offsets(), kCell}, place_, link().error(), observed_)) {}

  std::unique_ptr<const Likelihood> likelihood_;
  ObservedBurst observed_;
  std::vector<Ray> rays_;
  PlaceLikelihood place_;
  std::unique_ptr<const NearbyLikelihood> nearby_;
};

// A burst without the line of sight.
class NearbyCovered : public Nearby {
 protected:
  NearbyCovered() {
    const Vec3d there = kTruth + Vec3d{0.013, 0.006, 0.0};
    std::vector<Ray> reflected = link().rays(there);
    std::erase_if(reflected, [](const Ray& ray) { return ray.reflections == 0; });
    const ObservationModel model(link().room().grid, 3);
    observed_ = likelihood_->observe(model.expected({reflected, link().offsets(), 0.0}, {}));
    nearby_ =
        likelihood_->nearby({rays_, link().offsets(), kCell}, place_, link().error(), observed_);
  }
};

INSTANTIATE_TEST_SUITE_P(Kinds, NearbyCovered, ::testing::Values(LikelihoodKind::kPartial));
INSTANTIATE_TEST_SUITE_P(Kinds,
                         Nearby,
                         ::testing::Values(LikelihoodKind::kPartial, LikelihoodKind::kCoherent));

void expect_slopes_of_differences(const NearbyLikelihood& nearby) {
  constexpr double kStep = 1e-6;
  for (const Vec3d moved : {Vec3d{}, Vec3d{0.012, 0.004, 0.0}, Vec3d{-0.02, 0.017, 0.0}}) {
    const auto slope = nearby.at(moved);
    const auto difference = [&](const Vec3d& step) {
      return (nearby.at(moved + step).value - nearby.at(moved - step).value) / (2.0 * kStep);
    };
    const double scale = 1.0 + std::hypot(slope.by_x, slope.by_y);
    EXPECT_NEAR(slope.by_x, difference({kStep, 0.0, 0.0}), 1e-6 * scale);
    EXPECT_NEAR(slope.by_y, difference({0.0, kStep, 0.0}), 1e-6 * scale);
  }
}

TEST_P(Nearby, SlopeIsThatOfCentralDifferences) { expect_slopes_of_differences(*nearby_); }
TEST_P(NearbyCovered, SlopeIsThatOfCentralDifferences) { expect_slopes_of_differences(*nearby_); }

TEST_P(Nearby, MatchesATraceFromTheMovedPlace) {
  for (const Vec3d moved : {Vec3d{}, Vec3d{0.013, 0.006, 0.0}, Vec3d{-0.01, 0.012, 0.0}}) {
    const auto rays = link().rays(kTruth + moved);
    const ObservationModel::Place place{rays, link().offsets(), kCell};
    const auto model = likelihood_->close(place, link().error());
    const auto there = likelihood_->nearby(place, model, link().error(), observed_);
    // Strengths and the covariance are those of the middle.
    const double value = there->at({}).value;
    EXPECT_NEAR(nearby_->at(moved).value, value, 1.0 + 0.02 * std::abs(value));
  }
}

void expect_exact_lattice(const NearbyLikelihood& nearby) {
  const Lattice lattice{5, 3, 0.007, 0.006};
  const auto values = nearby.on(lattice);
  ASSERT_EQ(values.size(), 15U);
  for (std::size_t x = 0; x < 5; ++x) {
    for (std::size_t y = 0; y < 3; ++y) {
      const double exact = nearby.at(lattice.offset(x, y)).value;
      EXPECT_NEAR(values[x * 3 + y], exact, 0.5 + 0.01 * std::abs(exact));
    }
  }
}

TEST_P(Nearby, LatticeIsNearTheExactLengths) { expect_exact_lattice(*nearby_); }
TEST_P(NearbyCovered, LatticeIsNearTheExactLengths) { expect_exact_lattice(*nearby_); }

}  // namespace
}  // namespace rayloc::likelihood_test
