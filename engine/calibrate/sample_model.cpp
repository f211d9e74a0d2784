#include "engine/calibrate/sample_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kTurn = 2.0 * std::numbers::pi;

// A ray's delay and amplitude where the model is asked for.
struct RayValue {
  double delay = 0.0;
  Value amplitude;
};

RayValue value_of(const TracedSample& sample, const LinearRay& ray, const ModelPoint& at) {
  RayValue value{ray.delay, 0.0};
  Value log_amplitude;
  for (const RayTerm& term : sample.terms_of(ray)) {
    const double change = at.change[term.unknown];
    value.delay += term.delay * change;
    log_amplitude += term.log_amplitude * change;
  }
  value.delay +=
      ray.survey[0] * at.survey.x + ray.survey[1] * at.survey.y + ray.survey[2] * at.survey.z;
  value.amplitude = ray.amplitude * std::exp(log_amplitude);
  return value;
}

// exp(-j 2 pi f tau), of the whole turns only what counts.
Value carrier_phasor(double frequency, double delay) {
  const double turns = frequency * delay;
  return std::polar(1.0, -kTurn * (turns - std::floor(turns)));
}

// What is left of vectors when an array (times any complex factor) and its derivative by delay
// (times a real one) are taken out.
class Projection {
 public:
  Projection(const Eigen::VectorXcd& array,
             const Eigen::VectorXcd& by_delay,
             const Eigen::VectorXcd& y)
      : unit_(array / std::max(array.norm(), std::numeric_limits<double>::min())) {
    factor_ = unit_.dot(y) / std::max(array.norm(), std::numeric_limits<double>::min());
    along_ = by_delay * factor_;
    along_ -= unit_ * unit_.dot(along_);
    const double size = along_.norm();
    if (size > 0.0) {
      along_ /= size;
    }
  }

  // y ~ factor * array
  const Value& factor() const { return factor_; }

  template <typename Vector>
  void apply(Vector&& vector) const {
    vector -= unit_ * unit_.dot(vector);
    vector -= along_ * along_.dot(vector).real();
  }

 private:
  Eigen::VectorXcd unit_;
  Eigen::VectorXcd along_;
  Value factor_;
};

}  // namespace

SampleModel::SampleModel(const OfdmGrid& grid) : grid_(grid), basis_(grid), aligner_(grid) {
  // The basis vectors are those of the projection; their derivative by delay in the tones is a
  // multiplication, which the basis sees as a matrix.
  const std::size_t q = basis_.size();
  const std::size_t tones = grid.size();
  Eigen::MatrixXcd tone_of(tones, q);  // conj(basis)
  std::vector<Value> unit(tones);
  std::vector<Value> coordinates(q);
  for (std::size_t k = 0; k < tones; ++k) {
    std::fill(unit.begin(), unit.end(), Value());
    unit[k] = 1.0;
    basis_.project(unit, coordinates);
    for (std::size_t i = 0; i < q; ++i) {
      tone_of(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = coordinates[i];
    }
  }
  Eigen::VectorXcd omega(static_cast<Eigen::Index>(tones));
  for (std::size_t k = 0; k < tones; ++k) {
    omega(static_cast<Eigen::Index>(k)) = Value(0.0, -kTurn * grid.offset_hz(k));
  }
  slope_ = tone_of.transpose() * omega.asDiagonal() * tone_of.conjugate();
}

void SampleModel::add_ray(const Value& phasor,
                          double delay,
                          Eigen::Ref<Eigen::VectorXcd> sum) const {
  std::array<Value, 64> tone;
  const std::span<Value> coordinates(tone.data(), basis_.size());
  basis_.tone(delay, coordinates);
  for (std::size_t i = 0; i < basis_.size(); ++i) {
    sum(static_cast<Eigen::Index>(i)) += phasor * coordinates[i];
  }
}

Eigen::VectorXcd SampleModel::expected(const TracedSample& sample,
                                       double origin,
                                       const ModelPoint& at) const {
  const auto q = static_cast<Eigen::Index>(basis_.size());
  Eigen::VectorXcd array =
      Eigen::VectorXcd::Zero(q * static_cast<Eigen::Index>(sample.rays.size()));
  for (std::size_t e = 0; e < sample.rays.size(); ++e) {
    for (const LinearRay& ray : sample.rays[e]) {
      const RayValue value = value_of(sample, ray, at);
      add_ray(value.amplitude * carrier_phasor(grid_.centre_hz, value.delay),
              value.delay - origin,
              array.segment(static_cast<Eigen::Index>(e) * q, q));
    }
  }
  return array;
}

std::vector<Value> SampleModel::expected_tones(const TracedSample& sample,
                                               const ModelPoint& at) const {
  const std::size_t tones = grid_.size();
  std::vector<Value> h(sample.rays.size() * tones);
  for (std::size_t e = 0; e < sample.rays.size(); ++e) {
    for (const LinearRay& ray : sample.rays[e]) {
      const RayValue value = value_of(sample, ray, at);
      const Value phasor = value.amplitude * carrier_phasor(grid_.centre_hz, value.delay);
      for (std::size_t k = 0; k < tones; ++k) {
        h[e * tones + k] += phasor * std::polar(1.0, -kTurn * grid_.offset_hz(k) * value.delay);
      }
    }
  }
  return h;
}

MeasuredSample SampleModel::measured(const TracedSample& sample,
                                     const ModelPoint& at,
                                     std::span<const Value> h) const {
  const std::vector<Value> expected_h = expected_tones(sample, at);
  RAYLOC_CHECK(h.size() == expected_h.size());
  MeasuredSample result;
  result.origin = std::numeric_limits<double>::infinity();
  for (const auto& rays : sample.rays) {
    for (const LinearRay& ray : rays) {
      result.origin = std::min(result.origin, ray.delay);
    }
  }
  // `expected` delayed by -delay fits h; so h delayed by +delay fits `expected`.
  const Alignment alignment = aligner_.align(h, expected_h);
  std::vector<Value> aligned(h.begin(), h.end());
  aligner_.apply({-alignment.delay + result.origin, 1.0, 0.0}, aligned);
  double power = 0.0;
  for (const Value& value : aligned) {
    power += std::norm(value);
  }
  const std::size_t q = basis_.size();
  const std::size_t tones = grid_.size();
  std::vector<Value> coordinates(q * sample.rays.size());
  for (std::size_t e = 0; e < sample.rays.size(); ++e) {
    basis_.project(std::span(aligned).subspan(e * tones, tones),
                   std::span(coordinates).subspan(e * q, q));
  }
  result.y = Eigen::Map<const Eigen::VectorXcd>(coordinates.data(),
                                                static_cast<Eigen::Index>(coordinates.size()));
  const double inside = result.y.squaredNorm();
  result.outside = power > 0.0 ? std::max(0.0, 1.0 - inside / power) : 0.0;
  if (inside > 0.0) {
    result.y /= std::sqrt(inside);
  }
  return result;
}

Eigen::VectorXcd SampleModel::by_delay(const Eigen::VectorXcd& array) const {
  const Eigen::Index q = slope_.rows();
  Eigen::VectorXcd result(array.size());
  for (Eigen::Index at = 0; at < array.size(); at += q) {
    result.segment(at, q) = slope_ * array.segment(at, q);
  }
  return result;
}

double SampleModel::left_over(const Eigen::VectorXcd& expected, const Eigen::VectorXcd& y) const {
  const Projection projection(expected, by_delay(expected), y);
  Eigen::VectorXcd residual = y;
  projection.apply(residual);
  return residual.squaredNorm();
}

double SampleModel::unexplained(const TracedSample& sample,
                                const MeasuredSample& measured,
                                const ModelPoint& at) const {
  return left_over(expected(sample, measured.origin, at), measured.y);
}

SampleResidual SampleModel::residual(const TracedSample& sample,
                                     const MeasuredSample& measured,
                                     const ModelPoint& at,
                                     std::span<const std::uint32_t> unknowns) const {
  const auto q = static_cast<Eigen::Index>(basis_.size());
  const Eigen::Index rows = q * static_cast<Eigen::Index>(sample.rays.size());
  const auto count = static_cast<Eigen::Index>(unknowns.size());
  // Sums over the rays of phasor x (d tau, d ln a) x tone; the last three columns are the survey's.
  Eigen::MatrixXcd by_tau = Eigen::MatrixXcd::Zero(rows, count + 3);
  Eigen::MatrixXcd by_log = Eigen::MatrixXcd::Zero(rows, count);
  Eigen::VectorXcd array = Eigen::VectorXcd::Zero(rows);
  Eigen::VectorXcd share(q);
  for (std::size_t e = 0; e < sample.rays.size(); ++e) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * q;
    for (const LinearRay& ray : sample.rays[e]) {
      const RayValue value = value_of(sample, ray, at);
      share.setZero();
      add_ray(value.amplitude * carrier_phasor(grid_.centre_hz, value.delay),
              value.delay - measured.origin,
              share);
      array.segment(row, q) += share;
      for (const RayTerm& term : sample.terms_of(ray)) {
        const auto found = std::lower_bound(unknowns.begin(), unknowns.end(), term.unknown);
        if (found == unknowns.end() || *found != term.unknown) {
          continue;
        }
        const Eigen::Index column = found - unknowns.begin();
        if (term.delay != 0.0) {
          by_tau.col(column).segment(row, q) += term.delay * share;
        }
        if (term.log_amplitude != Value()) {
          by_log.col(column).segment(row, q) += term.log_amplitude * share;
        }
      }
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        by_tau.col(count + axis).segment(row, q) +=
            ray.survey.at(static_cast<std::size_t>(axis)) * share;
      }
    }
  }
  const Projection projection(array, by_delay(array), measured.y);
  SampleResidual result;
  result.value = measured.y;
  projection.apply(result.value);
  const Value carrier(0.0, -kTurn * grid_.centre_hz);
  const auto finish = [&](Eigen::Index column, Eigen::VectorXcd derivative) {
    derivative += carrier * by_tau.col(column) + by_delay(by_tau.col(column));
    derivative *= -projection.factor();
    projection.apply(derivative);
    return derivative;
  };
  result.derivative.resize(rows, count);
  for (Eigen::Index column = 0; column < count; ++column) {
    result.derivative.col(column) = finish(column, by_log.col(column));
  }
  result.by_survey.resize(rows, 3);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    result.by_survey.col(axis) = finish(count + axis, Eigen::VectorXcd::Zero(rows));
  }
  return result;
}

std::vector<double> SampleModel::scan(const TracedSample& sample,
                                      const MeasuredSample& measured,
                                      const ModelPoint& at,
                                      std::uint32_t unknown,
                                      std::span<const double> values) const {
  struct Moving {
    Eigen::Index row;
    RayValue value;
    RayTerm term;
  };
  std::vector<Moving> moving;
  const auto q = static_cast<Eigen::Index>(basis_.size());
  Eigen::VectorXcd rest = Eigen::VectorXcd::Zero(q * static_cast<Eigen::Index>(sample.rays.size()));
  for (std::size_t e = 0; e < sample.rays.size(); ++e) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * q;
    for (const LinearRay& ray : sample.rays[e]) {
      const RayValue value = value_of(sample, ray, at);
      const auto terms = sample.terms_of(ray);
      const auto found = std::find_if(
          terms.begin(), terms.end(), [&](const RayTerm& term) { return term.unknown == unknown; });
      if (found != terms.end()) {
        moving.push_back({row, value, *found});
      } else {
        add_ray(value.amplitude * carrier_phasor(grid_.centre_hz, value.delay),
                value.delay - measured.origin,
                rest.segment(row, q));
      }
    }
  }
  if (moving.empty()) {
    return {};
  }
  std::vector<double> result;
  for (const double value : values) {
    const double step = value - at.change[unknown];
    Eigen::VectorXcd array = rest;
    for (const Moving& one : moving) {
      const double delay = one.value.delay + one.term.delay * step;
      add_ray(one.value.amplitude * std::exp(one.term.log_amplitude * step) *
                  carrier_phasor(grid_.centre_hz, delay),
              delay - measured.origin,
              array.segment(one.row, q));
    }
    result.push_back(left_over(array, measured.y));
  }
  return result;
}

}  // namespace rayloc
