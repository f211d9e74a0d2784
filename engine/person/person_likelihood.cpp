#include "engine/person/person_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/likelihood/gain_profile.h"
#include "engine/likelihood/gaussian/covariance_factor.h"
#include "engine/person/path_errors.h"
#include "engine/person/triangle.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;
using Eigen::Index;

constexpr double kDelayStep = 2e-9;       // [s], between the delays that are tried
constexpr double kDelayDeviation = 1e-9;  // [s], sigma_T

constexpr double kMinPower = 1e-12;  // a ratio, chosen: keeps divisions from zero

// Noise power of one value, by second differences along the tones, where noise has six times its
// variance. The array is aligned to the empty room: from one tone to the next, a room's echoes
// change in phase by a tenth of a radian, a remaining timing offset by ten times that.
double noise_power(std::span<const Value> h, std::size_t tones) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t row = 0; row < h.size(); row += tones) {
    for (std::size_t k = row + 1; k + 1 < row + tones; ++k) {
      sum += std::norm(h[k - 1] - 2.0 * h[k] + h[k + 1]);
      ++count;
    }
  }
  return count == 0 ? 0.0 : sum / (6.0 * static_cast<double>(count));
}

// Received values of an antenna at every sample place: from `first` on, `size` per place.
struct SampleRows {
  Value* first = nullptr;
  std::size_t size = 0;
};

// Adds one ray.
void add_samples(const ScatteredRay& ray,
                 Value field,
                 std::span<const Value> s,
                 const PatchPlan& plan,
                 SampleRows samples) {
  std::vector<Value> turn_x(plan.count);
  std::vector<Value> turn_y(plan.count);
  for (std::size_t i = 0; i < plan.count; ++i) {
    turn_x[i] = field * std::exp(ray.slope_x * plan.at(i));
    turn_y[i] = std::exp(ray.slope_y * plan.at(i));
  }
  for (std::size_t i = 0; i < plan.count; ++i) {
    for (std::size_t j = 0; j < plan.count; ++j) {
      const Value here = turn_x[i] * turn_y[j];
      Value* out = samples.first + (i * plan.count + j) * samples.size;
      for (std::size_t c = 0; c < s.size(); ++c) {
        out[c] += Value(here.real() * s[c].real() - here.imag() * s[c].imag(),
                        here.real() * s[c].imag() + here.imag() * s[c].real());
      }
    }
  }
}

// W of a patch for its detailed evaluation.
Eigen::MatrixXcd whitener_of(const PersonPlace& place) {
  const auto n = static_cast<Index>(place.close.mean.size() / place.mean_power.size());
  Eigen::MatrixXcd whitener = Eigen::MatrixXcd::Zero(n, n);
  const std::complex<float>* next = place.close.whitener.data();
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j <= i; ++j) {
      whitener(i, j) = Value(*next++);
    }
  }
  return whitener;
}

}  // namespace

PersonLikelihood::PersonLikelihood(const OfdmGrid& grid,
                                   std::size_t antennas,
                                   const PersonLink& link,
                                   double distance)
    : grid_(grid),
      antennas_(antennas),
      distance_(distance),
      wave_number_(2.0 * std::numbers::pi * grid.centre_hz / kSpeedOfLight),
      basis_(grid),
      aligner_(grid),
      reference_(link.empty),
      diffuse_(basis_.diffuse_covariance(kDiffuseDecay)) {
  RAYLOC_CHECK(reference_.size() == antennas_ * grid_.size());
  scale_ = 1.0 / std::sqrt(std::max(power_of(reference_), kMinPower * kMinPower));
  for (Value& v : reference_) {
    v *= scale_;
  }
  const double first = distance_ / kSpeedOfLight;
  std::vector<Value> row(grid_.size());
  std::vector<Value> slope(grid_.size());
  empty_.resize(antennas_ * basis_.size());
  rotated_.resize(empty_.size());
  for (std::size_t m = 0; m < antennas_; ++m) {
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      const double w = 2.0 * std::numbers::pi * grid_.offset_hz(k);
      row[k] = reference_[m * grid_.size() + k] * std::polar(1.0, w * first);
      slope[k] = Value(0.0, w) * row[k];
    }
    basis_.project(row, {empty_.data() + m * basis_.size(), basis_.size()});
    basis_.project(slope, {rotated_.data() + m * basis_.size(), basis_.size()});
  }
}

PersonLikelihood::Observed PersonLikelihood::observe(std::span<const Value> h) const {
  RAYLOC_CHECK(h.size() == reference_.size());
  Observed observed;
  std::vector<Value> aligned(h.begin(), h.end());
  const Alignment alignment = aligner_.align(reference_, h);
  observed.correlation = alignment.correlation;
  aligner_.apply(alignment, aligned);
  const double first = distance_ / kSpeedOfLight;
  std::vector<Value> row(grid_.size());
  for (std::size_t t = 0; t < kDelays; ++t) {
    const double delay =
        first + kDelayStep * (static_cast<double>(t) - 0.5 * static_cast<double>(kDelays - 1));
    observed.y[t].resize(dimension());
    for (std::size_t m = 0; m < antennas_; ++m) {
      for (std::size_t k = 0; k < grid_.size(); ++k) {
        row[k] = aligned[m * grid_.size() + k] *
                 std::polar(1.0, 2.0 * std::numbers::pi * grid_.offset_hz(k) * delay);
      }
      basis_.project(row, {observed.y[t].data() + m * basis_.size(), basis_.size()});
    }
  }
  observed.re.resize(dimension());
  observed.im.resize(dimension());
  for (std::size_t i = 0; i < dimension(); ++i) {
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const Value value = observed.y[std::min(lane, kDelays - 1)][i];
      observed.re[i][lane] = static_cast<float>(value.real());
      observed.im[i][lane] = static_cast<float>(value.imag());
    }
  }
  observed.noise = noise_power(aligned, grid_.size()) * static_cast<double>(dimension()) /
                   std::max(power_of(aligned), kMinPower);
  return observed;
}

ScatteredPatch PersonLikelihood::patch(const ScatteredRays& rays,
                                       const PatchPlan& plan,
                                       double front_offset_sigma) const {
  RAYLOC_CHECK(rays.size() == antennas_);
  const std::size_t q = basis_.size();
  const std::size_t size = dimension();
  const std::size_t count = plan.count;
  ScatteredPatch patch;
  std::vector<Value> sample(count * count * size);
  patch.strength.assign(triangle_size(size), 0.0);
  patch.intra_cell_loss.assign(triangle_size(size), 0.0);
  PathErrors path_errors(antennas_, q);
  std::vector<Value> s(q);
  // Unit tone vectors times this have the norm of a response of amplitude 1 on all tones.
  const double level = scale_ * std::sqrt(static_cast<double>(grid_.size()));
  for (std::size_t m = 0; m < antennas_; ++m) {
    for (const ScatteredRay& ray : rays[m]) {
      basis_.tone((ray.length - distance_) / kSpeedOfLight, s);
      const Value field = level * ray.amplitude * std::polar(1.0, -wave_number_ * ray.length) *
                          std::exp(ray.slope_x * plan.offset_x + ray.slope_y * plan.offset_y);
      const double turn_x = ray.slope_x.imag();
      const double turn_y = ray.slope_y.imag();
      const double turn = turn_x * turn_x + turn_y * turn_y;  // [rad^2/m^2]
      // A front that is nearer by d is equivalent to a body that is nearer by d.
      const double unknown = -std::expm1(-front_offset_sigma * front_offset_sigma * turn);
      add_samples(ray, std::sqrt(1.0 - unknown) * field, s, plan, {sample.data() + m * q, size});
      const double power = std::norm(field);
      const double phase = plan.step() * plan.step() * turn / 12.0;
      add_outer(power, s, m * q, patch.strength);
      add_outer((1.0 - unknown) * power * -std::expm1(-phase), s, m * q, patch.intra_cell_loss);
      path_errors.add(m, ray, field, s, unknown);
      patch.power += power;
    }
  }
  patch.sample.assign(sample.begin(), sample.end());
  patch.path_errors = path_errors.all(plan.place_sigma());
  patch.front = path_errors.without_phase(plan.place_sigma());
  return patch;
}

// Zero mean. `sigma`: without the noise and the delay, lower triangle by rows.
WhitenedGaussian PersonLikelihood::gaussian_of(std::vector<Value> sigma,
                                               const PersonModel& model) const {
  const std::size_t size = dimension();
  add_outer(kDelayDeviation * kDelayDeviation, rotated_, 0, sigma);
  Eigen::MatrixXcd matrix(static_cast<Index>(size), static_cast<Index>(size));
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      matrix(static_cast<Index>(i), static_cast<Index>(j)) = sigma[triangle_size(i) + j];
    }
    matrix(static_cast<Index>(i), static_cast<Index>(i)) += model.noise / static_cast<double>(size);
  }
  return CovarianceFactor(matrix).gaussian();
}

PersonGaussian PersonLikelihood::gaussian_of(std::vector<Value> sigma,
                                             std::span<const Value> mean,
                                             const PersonModel& model) const {
  PersonGaussian gaussian{gaussian_of(std::move(sigma), model)};
  const auto whitened = whiten(gaussian, mean);
  gaussian.mean.assign(whitened.begin(), whitened.end());
  gaussian.mean_power = power_of(whitened);
  return gaussian;
}

PersonPlace PersonLikelihood::place(const ScatteredPatch& patch,
                                    Value scale,
                                    const PersonModel& model) const {
  const std::size_t size = dimension();
  const std::size_t q = basis_.size();
  const std::size_t places = patch.sample.size() / size;
  const double gain = std::norm(scale);
  std::vector<Value> sigma(triangle_size(size));
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    sigma[i] = gain * (model.strength_variance * patch.strength[i] + patch.intra_cell_loss[i] +
                       model.path_variance * patch.path_errors[i] + patch.front[i]);
  }
  const double diffuse = gain * model.diffuse * patch.power / static_cast<double>(antennas_);
  for (std::size_t m = 0; m < size; m += q) {
    for (std::size_t i = 0; i < q; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        sigma[triangle_size(m + i) + m + j] += diffuse * diffuse_[i * q + j];
      }
    }
  }
  PersonPlace place;
  place.close = gaussian_of(sigma, model);
  place.close.mean.reserve(patch.sample.size());
  place.mean_power.reserve(places);
  std::vector<Value> mean(size);
  std::vector<Value> mu(size);
  for (std::size_t p = 0; p < places; ++p) {
    for (std::size_t i = 0; i < size; ++i) {
      const Value z = scale * Value(patch.sample[p * size + i]);
      mean[i] += z / static_cast<double>(places);
      mu[i] = empty_[i] + z;
    }
    const auto whitened = whiten(place.close, mu);
    place.close.mean.insert(place.close.mean.end(), whitened.begin(), whitened.end());
    place.mean_power.push_back(static_cast<float>(power_of(whitened)));
  }
  for (std::size_t p = 0; p < places; ++p) {
    for (std::size_t i = 0; i < size; ++i) {
      mu[i] = scale * Value(patch.sample[p * size + i]) - mean[i];
    }
    add_outer(1.0 / static_cast<double>(places), mu, 0, sigma);
  }
  for (std::size_t i = 0; i < size; ++i) {
    mean[i] += empty_[i];
  }
  place.whole = gaussian_of(std::move(sigma), mean, model);
  return place;
}

PersonGaussian PersonLikelihood::no_person(const PersonModel& model) const {
  return gaussian_of(std::vector<Value>(triangle_size(dimension())), empty_, model);
}

PersonGaussian PersonLikelihood::changed(double share, const PersonModel& model) const {
  const std::size_t q = basis_.size();
  std::vector<Value> sigma(triangle_size(dimension()));
  for (std::size_t m = 0; m < dimension(); m += q) {
    for (std::size_t i = 0; i < q; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        sigma[triangle_size(m + i) + m + j] =
            share / static_cast<double>(antennas_) * diffuse_[i * q + j];
      }
    }
  }
  return gaussian_of(std::move(sigma), empty_, model);
}

// Sums the covariances of the people's patches, without the noise and the delay that every Gaussian
// has; keeps the directions in which the sum exceeds the noise.
OtherPeople PersonLikelihood::co_occupants(std::span<const PersonCandidate> people,
                                           const PersonModel& model) const {
  OtherPeople co_occupants;
  if (people.empty()) {
    return co_occupants;
  }
  const std::size_t size = dimension();
  const auto n = static_cast<Index>(size);
  co_occupants.added.resize(size);
  Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(n, n);
  Eigen::VectorXcd rotated(n);
  for (std::size_t i = 0; i < size; ++i) {
    rotated(static_cast<Index>(i)) = kDelayDeviation * rotated_[i];
  }
  const double noise = model.noise / static_cast<double>(size);
  for (const PersonCandidate& person : people) {
    const auto echo = echo_of(person);
    for (std::size_t i = 0; i < size; ++i) {
      co_occupants.added[i] += echo(static_cast<Index>(i));
    }
    const Eigen::MatrixXcd lower = whitener_of(*person.place)
                                       .triangularView<Eigen::Lower>()
                                       .solve(Eigen::MatrixXcd::Identity(n, n));
    sum += lower * lower.adjoint() - rotated * rotated.adjoint() -
           noise * Eigen::MatrixXcd::Identity(n, n);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> eigen(sum);
  for (Index i = n;
       i-- > 0 && co_occupants.spread.size() < OtherPeople::kMaxColumns;) {  // ascending
    const double variance = eigen.eigenvalues()(i);
    if (variance <= noise) {
      break;
    }
    const Eigen::VectorXcd column = std::sqrt(variance) * eigen.eigenvectors().col(i);
    co_occupants.spread.emplace_back(column.data(), column.data() + n);
  }
  return co_occupants;
}

double PersonLikelihood::log_likelihood(const PersonGaussian& gaussian,
                                        const Observed& observed,
                                        const OtherPeople& co_occupants) const {
  if (co_occupants.empty()) {
    LaneSums along;
    LaneRow power = rayloc::whiten(
        gaussian.whitener.data(), observed.re, observed.im, gaussian.mean, {&along, 1});
    for (float& one : power) {
      one = std::max(one, static_cast<float>(kMinPower));
    }
    const LaneRow best = at_best_gain(power, along, dimension());
    return static_cast<double>(*std::max_element(best.begin(), best.end())) - gaussian.mean_power -
           gaussian.log_determinant;
  }
  const AccompaniedGaussian with(gaussian, co_occupants);
  std::vector<Value> mean(gaussian.mean.begin(), gaussian.mean.end());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    mean[i] += with.shift()[i];
  }
  const auto reduced = with.reduced(mean);
  double best = -std::numeric_limits<double>::infinity();
  for (const auto& y : observed.y) {
    const auto u = whiten(gaussian, y);
    best = std::max(best,
                    gain_profile(std::max(with.power(u), kMinPower),
                                 std::abs(inner_product(reduced, u)),
                                 static_cast<double>(dimension())));
  }
  return best - inner_product(mean, reduced).real() - gaussian.log_determinant -
         with.log_determinant();
}

// Inner products of a burst with a sample place, at every delay.
struct PersonLikelihood::PlaceEvaluation {
  std::array<double, kDelays> power{};  // y^H Sigma^-1 y
  std::array<double, kDelays> along{};  // |mu^H Sigma^-1 y|
  double mean_power = 0.0;              // mu^H Sigma^-1 mu
};

// The sample places of a patch with other people present.
class PersonLikelihood::AccompaniedPlace {
 public:
  AccompaniedPlace(const PersonPlace& place,
                   const Observed& observed,
                   const OtherPeople& co_occupants)
      : place_(place), with_(place.close, co_occupants) {
    for (std::size_t t = 0; t < kDelays; ++t) {
      const auto u = whiten(place.close, observed.y[t]);
      power_[t] = std::max(with_.power(u), kMinPower);
      reduced_[t] = with_.reduced(u);
    }
  }

  double log_determinant() const { return place_.close.log_determinant + with_.log_determinant(); }
  PlaceEvaluation at(std::size_t sample) const {
    const auto mean = place_.mean_of(sample);
    std::vector<Value> whitened(mean.begin(), mean.end());
    for (std::size_t i = 0; i < whitened.size(); ++i) {
      whitened[i] += with_.shift()[i];
    }
    PlaceEvaluation evaluation{power_, {}, with_.power(whitened)};
    for (std::size_t t = 0; t < kDelays; ++t) {
      evaluation.along[t] = std::abs(inner_product(whitened, reduced_[t]));
    }
    return evaluation;
  }

 private:
  const PersonPlace& place_;
  AccompaniedGaussian with_;
  std::array<double, kDelays> power_{};
  std::array<std::vector<Value>, kDelays> reduced_;  // reduced() of W y
};

void PersonLikelihood::log_likelihood(const PersonPlace& place,
                                      const Observed& observed,
                                      const OtherPeople& co_occupants,
                                      std::span<double> out) const {
  RAYLOC_CHECK(out.size() == place.mean_power.size());
  if (co_occupants.empty()) {
    std::vector<LaneSums> along(out.size());
    LaneRow power = rayloc::whiten(
        place.close.whitener.data(), observed.re, observed.im, place.close.mean, along);
    for (float& one : power) {
      one = std::max(one, static_cast<float>(kMinPower));
    }
    for (std::size_t p = 0; p < out.size(); ++p) {
      const LaneRow best = at_best_gain(power, along[p], dimension());
      out[p] = static_cast<double>(*std::max_element(best.begin(), best.end())) -
               static_cast<double>(place.mean_power[p]) - place.close.log_determinant;
    }
    return;
  }
  const AccompaniedPlace with(place, observed, co_occupants);
  for (std::size_t p = 0; p < out.size(); ++p) {
    const PlaceEvaluation evaluation = with.at(p);
    double best = -std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < kDelays; ++t) {
      best = std::max(
          best,
          gain_profile(evaluation.power[t], evaluation.along[t], static_cast<double>(dimension())));
    }
    out[p] = best - evaluation.mean_power - with.log_determinant();
  }
}

// a dH of a sample place.
Eigen::VectorXcd PersonLikelihood::echo_of(const PersonCandidate& candidate) const {
  const auto mean = candidate.place->mean_of(candidate.sample);
  Eigen::VectorXcd echo(static_cast<Index>(mean.size()));
  std::transform(mean.begin(), mean.end(), echo.data(), [](std::complex<float> value) {
    return Value(value);
  });
  whitener_of(*candidate.place).triangularView<Eigen::Lower>().solveInPlace(echo);
  return echo - Eigen::Map<const Eigen::VectorXcd>(empty_.data(), echo.size());
}

double PersonLikelihood::echo_power(const PersonCandidate& candidate) const {
  return echo_of(candidate).squaredNorm();
}

double PersonLikelihood::misfit(const PersonCandidate& candidate,
                                const Observed& observed,
                                const OtherPeople& co_occupants) const {
  const auto d = static_cast<double>(dimension());
  const OtherPeople no_person{std::vector<Value>(dimension()), {}};
  const PlaceEvaluation evaluation =
      AccompaniedPlace(*candidate.place, observed, co_occupants.empty() ? no_person : co_occupants)
          .at(candidate.sample);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < kDelays; ++t) {
    const double a = evaluation.power[t];
    const double b = evaluation.along[t];
    const double r = best_gain(a, b, d);
    least = std::min(least, (a * r * r - 2.0 * b * r + evaluation.mean_power) / d);
  }
  return least;
}

}  // namespace rayloc
