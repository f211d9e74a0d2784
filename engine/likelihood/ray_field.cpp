#include "engine/likelihood/ray_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "engine/base/check.h"
#include "engine/base/work_done.h"
#include "engine/likelihood/gain_profile.h"
#include "engine/likelihood/known_rays.h"
#include "engine/likelihood/min_power.h"
#include "engine/likelihood/place_moments.h"

namespace rayloc {
namespace {

using Eigen::Index;

constexpr double kFieldLeftOut = 1e-5;  // share of the known power, chosen: below any noise

void put_lane(std::complex<float> value, std::size_t lane, LaneSums& to) {
  to.re[lane] = value.real();
  to.im[lane] = value.imag();
}

// blocks: of eight rays each.
void put_ray(std::complex<float> value, std::size_t ray, LaneSums* blocks) {
  put_lane(value, ray % kLaneCount, blocks[ray / kLaneCount]);
}

std::complex<float> single(double phase) { return std::complex<float>(std::polar(1.0, phase)); }

Bidiagonal bidiagonal_factor(const FieldCovariance& of, double noise) {
  Bidiagonal factor;
  const std::size_t size = of.diagonal.size();
  factor.below.resize(size);
  factor.scale.resize(size);
  double log_determinant = 0.0;
  double d = of.diagonal[0] + noise;
  for (std::size_t i = 0;; ++i) {
    RAYLOC_CHECK(d > 0.0);
    factor.scale[i] = static_cast<float>(1.0 / std::sqrt(d));
    log_determinant += std::log(d);
    if (i + 1 == size) {
      break;
    }
    const double below = of.beside[i] / d;
    factor.below[i] = static_cast<float>(below);
    d = of.diagonal[i + 1] + noise - below * of.beside[i];
  }
  factor.log_determinant = static_cast<float>(log_determinant);
  return factor;
}

}  // namespace

FieldCovariance field_covariance(const ObservationModel& model,
                                 const ObservationModel::Place& place,
                                 const ModelError& error) {
  RAYLOC_CHECK(!place.rays.empty());
  FieldCovariance out;
  const auto terms = model.ray_terms(place, error);
  KnownRays known = known_rays(model, place, terms, kFieldRays, kFieldLeftOut);
  const auto size = static_cast<Index>(model.dimension());
  const PlaceMoments moments = unknown_moments(model, place, error, terms, known);
  out.known = std::move(known.rays);
  out.has_direct = known.has_direct;
  const Eigen::Tridiagonalization<Eigen::MatrixXcd> reduced(moments.covariance(
      place.element_offset.size(), model.diffuse_covariance(error.diffuse_decay)));
  const Eigen::MatrixXcd q = reduced.matrixQ();
  // Cost: the products of the unknown rays, the reduction and its Q, in double precision.
  const std::size_t side = model.dimension();
  WorkDone::add(4 * side * side * place.rays.size() + 11 * side * side * side,
                16 * side * (place.rays.size() + 2 * side));
  out.turn.reserve(side * side);
  out.diagonal.reserve(side);
  out.beside.reserve(side);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      out.turn.emplace_back(std::conj(q(j, i)));
    }
    out.diagonal.push_back(reduced.diagonal()(i));
    if (i + 1 < size) {
      out.beside.push_back(reduced.subDiagonal()(i));
    }
  }
  return out;
}

RayField ray_field(const ObservationModel& model,
                   const FieldCovariance& covariance,
                   const ObservationModel::Place& place,
                   const ModelError& error,
                   const FieldLattice& lattice) {
  const Lattice& plan = lattice.plan;
  RAYLOC_CHECK(plan.count_y % kLaneCount == 0);
  const std::size_t size = model.dimension();
  RayField field;
  field.rays = covariance.known.size();
  const std::size_t blocks = ray_blocks(field.rays);
  field.known.resize(size * blocks);
  field.by_x.resize(plan.count_x * blocks);
  field.by_z.resize(lattice.heights.size() * blocks);
  field.by_y.resize(plan.count_y / kLaneCount * field.rays);
  const auto terms = model.ray_terms(place, error);
  const double k = model.wave_number();
  for (std::size_t n = 0; n < field.rays; ++n) {
    const std::size_t p = covariance.known[n];
    const Ray& ray = place.rays[p];
    Eigen::VectorXcd v(static_cast<Index>(size));
    model.put_array(place, terms, p, {v.data(), size});
    v *= terms.parts[p].known;
    WorkDone::add(8 * size * size, size * (size + 4) * sizeof(std::complex<float>));
    for (std::size_t i = 0; i < size; ++i) {
      std::complex<float> sum;
      for (std::size_t j = 0; j < size; ++j) {
        const std::complex<float> a = covariance.turn[i * size + j];
        const std::complex<float> b(v(static_cast<Index>(j)));
        sum += std::complex<float>(a.real() * b.real() - a.imag() * b.imag(),
                                   a.real() * b.imag() + a.imag() * b.real());
      }
      put_ray(sum, n, field.known.data() + i * blocks);
    }
    for (std::size_t x = 0; x < plan.count_x; ++x) {
      put_ray(single(k * ray.at_device.x * plan.offset(x, 0).x), n, field.by_x.data() + x * blocks);
    }
    for (std::size_t y = 0; y < plan.count_y; ++y) {
      put_lane(single(k * ray.at_device.y * plan.offset(0, y).y),
               y % kLaneCount,
               field.by_y[y / kLaneCount * field.rays + n]);
    }
    for (std::size_t z = 0; z < lattice.heights.size(); ++z) {
      const Vec3d path = ray.length * ray.at_device - Vec3d{0.0, 0.0, lattice.heights[z]};
      put_ray(single(-k * (norm(path) - ray.length)), n, field.by_z.data() + z * blocks);
    }
  }
  return field;
}

FieldBurst::FieldBurst(const FieldCovariance& covariance,
                       const ObservedArray& observed,
                       double noise)
    : covariance_(covariance),
      observed_(observed),
      factor_(
          bidiagonal_factor(covariance, noise / static_cast<double>(covariance.diagonal.size()))),
      burst_(covariance.diagonal.size()) {}

void FieldBurst::take(const ObservedArray::Block& block) {
  turn_and_whiten(covariance_.turn, factor_, block.re, block.im, burst_);
  power_.fill(kMinSinglePower);
  for (const LaneSums& one : burst_) {
    for (std::size_t t = 0; t < kLaneCount; ++t) {
      power_[t] += one.re[t] * one.re[t] + one.im[t] * one.im[t];
    }
  }
}

// Best delay of the block for arbitrary phases of the rays.
std::size_t FieldBurst::best_of(std::span<const RaySums> z, std::size_t rays) const {
  std::array<double, kLaneCount> values{};
  for (std::size_t t = 0; t < kLaneCount; ++t) {
    const RaySums along = along_of(z, delay(t));
    float sum = 0.0F;
    for (std::size_t p = 0; p < rays; ++p) {
      sum += along.re[p] * along.re[p] + along.im[p] * along.im[p];
    }
    values[t] = gain_profile(static_cast<double>(power_[t]),
                             std::sqrt(static_cast<double>(sum)),
                             static_cast<double>(burst_.size()));
  }
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

std::vector<std::complex<float>> FieldBurst::delay(std::size_t t) const {
  std::vector<std::complex<float>> x;
  x.reserve(burst_.size());
  for (const LaneSums& one : burst_) {
    x.emplace_back(one.re[t], one.im[t]);
  }
  return x;
}

FieldTerms FieldBurst::terms(const RayField& field) {
  std::vector<RaySums> z(burst_.size());
  whiten_rays(factor_, field.known, z);
  if (best_.empty()) {
    take(observed_.coarse);
    take(observed_.windows[best_of(z, field.rays)]);
    const std::size_t best = best_of(z, field.rays);
    for (const std::size_t t : {best, best - 1, best + 1}) {
      if (t < kLaneCount) {
        of_delays_.power_inverse[best_.size()] = 1.0F / power_[t];
        of_delays_.log_power[best_.size()] = std::log(power_[t]);
        best_.push_back(delay(t));
      }
    }
    of_delays_.delays = best_.size();
    of_delays_.has_direct = covariance_.has_direct;
    of_delays_.log_obstructed = static_cast<float>(kLogObstructed);
    of_delays_.dimension = static_cast<float>(burst_.size());
    of_delays_.less = factor_.log_determinant;
  }
  FieldTerms terms = of_delays_;
  terms.rays = field.rays;
  for (std::size_t k = 0; k < terms.delays; ++k) {
    terms.along[k] = along_of(z, best_[k]);
  }
  gram_of(z, terms);
  return terms;
}

}  // namespace rayloc
