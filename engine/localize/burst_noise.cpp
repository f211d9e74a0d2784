#include "engine/localize/burst_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include <Eigen/Core>

namespace rayloc {
namespace {

using Eigen::Index;
using Eigen::VectorXcf;
using Coordinates = Eigen::Map<const VectorXcf>;

constexpr double kLeastCounted = 0.2;  // of the model's noise: less is a unit of log-likelihood
constexpr double kLeastPower = 1e-12;

// A row of the triangle W.
Coordinates row_of(const PlaceModel& place, Index i) {
  return {place.whitener.data() + i * (i + 1) / 2, i + 1};
}

// W x
VectorXcf times(const PlaceModel& place, const VectorXcf& x) {
  VectorXcf result(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    result(i) = (row_of(place, i).transpose() * x.head(i + 1)).value();
  }
  return result;
}

// W^H x
VectorXcf times_adjoint(const PlaceModel& place, const VectorXcf& x) {
  VectorXcf result = VectorXcf::Zero(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    result.head(i + 1) += x(i) * row_of(place, i).conjugate();
  }
  return result;
}

template <typename Vector>
double power_of(const Vector& x) {
  return static_cast<double>(x.squaredNorm());
}

}  // namespace

bool counts_noise(double n, const ObservedArray& observed) {
  return observed.noise > kLeastCounted * n;
}

double log_likelihood_with_noise(const PlaceModel& place,
                                 const ObservedArray& observed,
                                 const ObservedArray::Block& block,
                                 std::size_t lane) {
  const auto size = static_cast<Index>(block.re.size());
  const auto dimension = static_cast<double>(size);
  VectorXcf y(size);
  for (Index i = 0; i < size; ++i) {
    const auto coordinate = static_cast<std::size_t>(i);
    y(i) = {block.re[coordinate][lane], block.im[coordinate][lane]};
  }
  const VectorXcf whitened = times(place, y);
  // tr Sigma^-1
  const double trace = power_of(Coordinates(place.whitener.data(), size * (size + 1) / 2));
  const VectorXcf inverse = times_adjoint(place, whitened);  // Sigma^-1 y
  const VectorXcf twice = times(place, inverse);             // W Sigma^-1 y
  const double power = power_of(whitened);
  const double inverse_power = power_of(inverse);
  // The gain is that of (Sigma + n' I / D)^-1 ~ Sigma^-1 - `less` Sigma^-2, which is exact where
  // there is nothing but noise.
  const auto n = static_cast<double>(place.noise);
  const double less = n / dimension * observed.noise / (n + observed.noise);
  const double a = std::max(power - less * inverse_power, kLeastPower);
  const double noise = observed.noise / dimension;
  double best = std::numeric_limits<double>::lowest();
  for (std::size_t first = 0; first < place.mean.size(); first += block.re.size()) {
    const bool is_covered = first > 0;
    const PlaceModel::Powers& of_mean = is_covered ? place.covered : place.open;
    const Coordinates mean(place.mean.data() + first, size);
    const std::complex<double> along(whitened.dot(mean));
    const std::complex<double> inverse_along(twice.dot(mean));
    const std::complex<double> lessened = along - less * inverse_along;
    const double b = std::abs(lessened);
    const double r = (b + std::sqrt(b * b + 4.0 * a * dimension)) / (2.0 * a);
    const std::complex<double> turn = b > 0.0 ? std::conj(lessened) / b : 1.0;
    // |r y - mu|^2 in one metric and in the other.
    const auto misfit = [&](double of_y, const std::complex<double>& of_both, float of_mu) {
      return std::max(r * r * of_y - 2.0 * r * (turn * of_both).real() + static_cast<double>(of_mu),
                      kLeastPower);
    };
    const double left = misfit(power, along, of_mean.whitened);
    const double inverse_left = misfit(inverse_power, inverse_along, of_mean.inverse);
    best = std::max(best,
                    2.0 * dimension * std::log(r) - left / (1.0 + noise * inverse_left / left) +
                        (is_covered ? kLogCovered : 0.0));
  }
  return best - static_cast<double>(place.log_determinant) -
         dimension * std::log1p(noise * trace / dimension);
}

ModelError with_noise(ModelError error, const ObservedArray& observed) {
  error.noise += observed.noise;
  return error;
}

}  // namespace rayloc
