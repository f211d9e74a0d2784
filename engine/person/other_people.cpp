#include "engine/person/other_people.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {

using Value = std::complex<double>;

AccompaniedGaussian::AccompaniedGaussian(const WhitenedGaussian& gaussian,
                                         const OtherPeople& co_occupants)
    : gaussian_(gaussian),
      columns_(co_occupants.spread.size()),
      shift_(whiten(gaussian, co_occupants.added)) {
  RAYLOC_CHECK(columns_ <= OtherPeople::kMaxColumns);
  for (std::size_t c = 0; c < columns_; ++c) {
    b_[c] = whiten(gaussian, co_occupants.spread[c]);
  }
  // M = C C^H by rows; its diagonal is at least 1.
  for (std::size_t i = 0; i < columns_; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Value m = inner_product(b_[i], b_[j]) + (i == j ? 1.0 : 0.0);
      for (std::size_t k = 0; k < j; ++k) {
        m -= factor_[i][k] * std::conj(factor_[j][k]);
      }
      factor_[i][j] = i == j ? Value(std::sqrt(std::max(m.real(), 1.0))) : m / factor_[j][j].real();
    }
    log_determinant_ += 2.0 * std::log(factor_[i][i].real());
  }
}

// C^-1 x
void AccompaniedGaussian::solve(std::span<Value> x) const {
  for (std::size_t i = 0; i < columns_; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      x[i] -= factor_[i][j] * x[j];
    }
    x[i] /= factor_[i][i].real();
  }
}

AccompaniedGaussian::Column AccompaniedGaussian::along(std::span<const Value> u) const {
  Column result{};
  for (std::size_t c = 0; c < columns_; ++c) {
    result[c] = inner_product(b_[c], u);
  }
  solve(std::span(result).first(columns_));
  return result;
}

double AccompaniedGaussian::power(std::span<const Value> u) const {
  double result = power_of(u);
  for (const Value& value : along(u)) {
    result -= std::norm(value);
  }
  return std::max(result, 0.0);
}

std::vector<Value> AccompaniedGaussian::reduced(std::span<const Value> u) const {
  Column weight = along(u);  // M^-1 B^H u = C^-H (C^-1 B^H u)
  for (std::size_t i = columns_; i-- > 0;) {
    for (std::size_t j = i + 1; j < columns_; ++j) {
      weight[i] -= std::conj(factor_[j][i]) * weight[j];
    }
    weight[i] /= factor_[i][i].real();
  }
  std::vector<Value> result(u.begin(), u.end());
  for (std::size_t c = 0; c < columns_; ++c) {
    const double re = weight[c].real();
    const double im = weight[c].imag();
    for (std::size_t k = 0; k < result.size(); ++k) {
      const Value b = b_[c][k];
      result[k] -= Value(re * b.real() - im * b.imag(), re * b.imag() + im * b.real());
    }
  }
  return result;
}

}  // namespace rayloc
