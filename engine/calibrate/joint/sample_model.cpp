#include "engine/calibrate/joint/sample_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kTurn = 2.0 * std::numbers::pi;  // [rad], one full cycle
constexpr double kMinLeftOver = 0.03;             // of the largest residual of a coordinate
constexpr int kAlignmentSteps = 3;  // a count, chosen: each is linear in the remaining delay
constexpr double kMinShare = 0.02;  // residual of a sample, below which its weight saturates

// A ray's delay and amplitude at the requested point.
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

// exp(-j 2 pi f tau), evaluated with the fractional part of the cycles.
Value carrier_phasor(double frequency, double delay) {
  const double turns = frequency * delay;
  return std::polar(1.0, -kTurn * (turns - std::floor(turns)));
}

// Removes from vectors the components along an array (times any complex factor) and along its
// derivative by delay (times a real one).
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
      delay_ = along_.dot(y).real() / size;
    }
  }

  // y ~ factor * array
  const Value& factor() const { return factor_; }
  // Delay by which the array would have to be later, to first order.
  double delay() const { return delay_; }

  template <typename Vector>
  void apply(Vector&& vector) const {
    vector -= unit_ * unit_.dot(vector);
    vector -= along_ * along_.dot(vector).real();
  }

 private:
  Eigen::VectorXcd unit_;
  Eigen::VectorXcd along_;
  Value factor_;
  double delay_ = 0.0;
};

// Adds the mutual coupling of the antennas to the segment of each.
void couple(const TracedSample& sample, const ModelPoint& at, std::span<Value> array) {
  const std::size_t elements = sample.rays.size();
  const auto factors = std::span(at.change).subspan(sample.coupling, 2 * elements * (elements - 1));
  if (std::all_of(factors.begin(), factors.end(), [](double part) { return part == 0.0; })) {
    return;
  }
  const std::size_t size = array.size() / elements;
  const std::vector<Value> own(array.begin(), array.end());
  std::uint32_t unknown = sample.coupling;
  for (std::size_t a = 0; a < elements; ++a) {
    for (std::size_t b = 0; b < elements; ++b) {
      if (a == b) {
        continue;
      }
      const Value factor(at.change[unknown], at.change[unknown + 1]);
      for (std::size_t i = 0; factor != Value() && i < size; ++i) {
        array[a * size + i] += factor * own[b * size + i];
      }
      unknown += 2;
    }
  }
}

// Adds the derivatives of couple() by the coupling unknowns in `unknowns` to their columns.
void add_coupling(const TracedSample& sample,
                  std::span<const std::uint32_t> unknowns,
                  const Eigen::VectorXcd& array,
                  Eigen::MatrixXcd& derivative) {
  const auto elements = static_cast<Eigen::Index>(sample.rays.size());
  const Eigen::Index q = array.size() / elements;
  std::uint32_t unknown = sample.coupling;
  for (Eigen::Index a = 0; a < elements; ++a) {
    for (Eigen::Index b = 0; b < elements; ++b) {
      for (int part = 0; a != b && part < 2; ++part, ++unknown) {
        const auto found = std::lower_bound(unknowns.begin(), unknowns.end(), unknown);
        if (found != unknowns.end() && *found == unknown) {
          derivative.col(found - unknowns.begin()).segment(a * q, q) +=
              (part == 0 ? Value(1.0) : Value(0.0, 1.0)) * array.segment(b * q, q);
        }
      }
    }
  }
}

std::span<Value> entries(Eigen::Ref<Eigen::VectorXcd> array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

// Adds a ray's derivatives to the rows of its antenna; `share`: the ray's part of the array.
void add_terms(std::span<const RayTerm> terms,
               std::span<const std::uint32_t> unknowns,
               const Eigen::VectorXcd& share,
               Eigen::Ref<Eigen::MatrixXcd> by_tau,
               Eigen::Ref<Eigen::MatrixXcd> by_log) {
  for (const RayTerm& term : terms) {
    const auto found = std::lower_bound(unknowns.begin(), unknowns.end(), term.unknown);
    if (found == unknowns.end() || *found != term.unknown) {
      continue;
    }
    const Eigen::Index column = found - unknowns.begin();
    if (term.delay != 0.0) {
      by_tau.col(column) += term.delay * share;
    }
    if (term.log_amplitude != Value()) {
      by_log.col(column) += term.log_amplitude * share;
    }
  }
}

void couple_columns(const TracedSample& sample, const ModelPoint& at, Eigen::MatrixXcd& arrays) {
  for (Eigen::Index column = 0; column < arrays.cols(); ++column) {
    couple(sample, at, entries(arrays.col(column)));
  }
}

}  // namespace

SampleModel::SampleModel(const OfdmGrid& grid)
    : grid_(grid), cfr_(grid), basis_(grid), aligner_(grid) {
  // The basis vectors are those of the projection. Their derivative by delay is a multiplication in
  // the tones and a matrix in the basis.
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

SampleModel SampleModel::weighed(const Eigen::MatrixXcd& left_over) const {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> eigen(left_over);
  // The weight of a coordinate is bounded.
  const Eigen::VectorXd power =
      eigen.eigenvalues().cwiseMax(kMinLeftOver * eigen.eigenvalues().maxCoeff());
  SampleModel result = *this;
  result.weighed_ = true;
  result.weight_ = eigen.eigenvectors() *
                   (power / power.mean()).cwiseSqrt().cwiseInverse().asDiagonal() *
                   eigen.eigenvectors().adjoint();
  return result;
}

Eigen::MatrixXcd SampleModel::nothing_left_over() const {
  return Eigen::MatrixXcd::Zero(slope_.rows(), slope_.cols());
}

void SampleModel::add_left_over(const TracedSample& sample,
                                const ModelPoint& at,
                                std::span<const Value> h,
                                Eigen::MatrixXcd& sum) const {
  const SampleResidual left = residual(sample, measured(sample, at, h), at, {});
  const double share = kMinShare + left.unexplained();
  for (Eigen::Index row = 0; row < left.value.size(); row += sum.rows()) {
    const auto one = left.value.segment(row, sum.rows());
    sum += one * one.adjoint() / share;
  }
}

void SampleModel::weigh(Eigen::Ref<Eigen::VectorXcd> array) const {
  if (!weighed_) {
    return;
  }
  const Eigen::Index q = weight_.rows();
  for (Eigen::Index at = 0; at < array.size(); at += q) {
    array.segment(at, q) = (weight_ * array.segment(at, q)).eval();
  }
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
  couple(sample, at, entries(array));
  return array;
}

std::vector<Value> SampleModel::expected_tones(const TracedSample& sample,
                                               const ModelPoint& at) const {
  const std::size_t tones = grid_.size();
  std::vector<Value> h(sample.rays.size() * tones);
  std::vector<double> a_re;
  std::vector<double> a_im;
  std::vector<double> tau;
  for (std::size_t e = 0; e < sample.rays.size(); ++e) {
    a_re.clear();
    a_im.clear();
    tau.clear();
    for (const LinearRay& ray : sample.rays[e]) {
      const RayValue value = value_of(sample, ray, at);
      a_re.push_back(value.amplitude.real());
      a_im.push_back(value.amplitude.imag());
      tau.push_back(value.delay);
    }
    cfr_.forward({a_re, a_im, tau}, std::span(h).subspan(e * tones, tones));
  }
  couple(sample, at, h);
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
  if (!std::isfinite(result.origin)) {  // no ray reaches it: all of h is residual
    result.origin = 0.0;
  }
  // `expected` delayed by -delay fits h; so h delayed by +delay fits `expected`.
  double delay = -aligner_.align(h, expected_h).delay;
  result.y = coordinates(h, delay + result.origin);
  double power = 0.0;
  for (const Value& value : h) {
    power += std::norm(value);
  }
  result.outside = power > 0.0 ? std::max(0.0, 1.0 - result.y.squaredNorm() / power) : 0.0;
  weigh(result.y);
  if (weighed_) {  // the best delays are different then
    Eigen::VectorXcd array = expected(sample, result.origin, at);
    Eigen::VectorXcd delayed = by_delay(array);
    weigh(array);
    weigh(delayed);
    for (int step = 0; step < kAlignmentSteps; ++step) {
      delay += Projection(array, delayed, result.y).delay();
      result.y = coordinates(h, delay + result.origin);
      weigh(result.y);
    }
  }
  const double inside = result.y.squaredNorm();
  if (inside > 0.0) {
    result.y /= std::sqrt(inside);
  }
  return result;
}

// Coordinates of `h`, advanced by `delay`.
Eigen::VectorXcd SampleModel::coordinates(std::span<const Value> h, double delay) const {
  std::vector<Value> earlier(h.begin(), h.end());
  aligner_.apply({delay, 1.0, 0.0}, earlier);
  const std::size_t q = basis_.size();
  const std::size_t tones = grid_.size();
  const std::size_t elements = h.size() / tones;
  std::vector<Value> result(q * elements);
  for (std::size_t e = 0; e < elements; ++e) {
    basis_.project(std::span(earlier).subspan(e * tones, tones),
                   std::span(result).subspan(e * q, q));
  }
  return Eigen::Map<const Eigen::VectorXcd>(result.data(),
                                            static_cast<Eigen::Index>(result.size()));
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
  Eigen::VectorXcd array = expected;
  Eigen::VectorXcd delayed = by_delay(expected);
  weigh(array);
  weigh(delayed);
  const Projection projection(array, delayed, y);
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
      if (count > 0) {  // rows cannot be taken from a matrix without columns
        add_terms(sample.terms_of(ray),
                  unknowns,
                  share,
                  by_tau.middleRows(row, q),
                  by_log.middleRows(row, q));
      }
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        by_tau.col(count + axis).segment(row, q) +=
            ray.survey.at(static_cast<std::size_t>(axis)) * share;
      }
    }
  }
  couple_columns(sample, at, by_tau);
  couple_columns(sample, at, by_log);
  add_coupling(sample, unknowns, array, by_log);
  couple(sample, at, entries(array));
  Eigen::VectorXcd delayed = by_delay(array);
  weigh(array);
  weigh(delayed);
  const Projection projection(array, delayed, measured.y);
  SampleResidual result;
  result.value = measured.y;
  projection.apply(result.value);
  const Value carrier(0.0, -kTurn * grid_.centre_hz);
  const auto finish = [&](Eigen::Index column, Eigen::VectorXcd derivative) {
    derivative += carrier * by_tau.col(column) + by_delay(by_tau.col(column));
    weigh(derivative);
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
    couple(sample, at, entries(array));
    result.push_back(left_over(array, measured.y));
  }
  return result;
}

}  // namespace rayloc
