#include "engine/likelihood/burst_noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "engine/likelihood/gain_profile.h"
#include "engine/likelihood/gaussian/whitened_gaussian.h"
#include "engine/likelihood/min_power.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kMinCounted = 0.2;  // ratio to n; below, the error is a unit of log-likelihood

}  // namespace

bool lacks_noise(const PlaceModel& place, const ObservedArray& observed) {
  return place.noise > 0.0F && observed.noise > kMinCounted * static_cast<double>(place.noise);
}

double log_likelihood_with_noise(const PlaceModel& place,
                                 const ObservedArray& observed,
                                 const ObservedArray::Block& block,
                                 std::size_t lane) {
  const std::size_t size = block.re.size();
  const auto dimension = static_cast<double>(size);
  std::vector<Value> y(size);
  for (std::size_t i = 0; i < size; ++i) {
    y[i] = {static_cast<double>(block.re[i][lane]), static_cast<double>(block.im[i][lane])};
  }
  double trace = 0.0;  // of Sigma^-1
  for (const std::complex<float>& w : place.whitener) {
    trace += static_cast<double>(std::norm(w));
  }
  const auto whitened = whiten(place, y);
  const auto inverse = unwhiten(place, whitened);  // Sigma^-1 y
  const auto twice = whiten(place, inverse);       // W Sigma^-1 y
  const double power = power_of(whitened);
  const double inverse_power = power_of(inverse);
  // The gain is that of (Sigma + n' I / D)^-1 ~ Sigma^-1 - `less` Sigma^-2, which is exact if Sigma
  // is noise only.
  const auto n = static_cast<double>(place.noise);
  const double less = n / dimension * observed.noise / (n + observed.noise);
  const double a = std::max(power - less * inverse_power, kMinPower);
  const double noise = observed.noise / dimension;
  double best = std::numeric_limits<double>::lowest();
  for (std::size_t first = 0; first < place.mean.size(); first += size) {
    const bool is_obstructed = first > 0;
    const PlaceModel::Powers& of_mean = is_obstructed ? place.obstructed : place.open;
    const std::vector<Value> mean(place.mean.begin() + static_cast<std::ptrdiff_t>(first),
                                  place.mean.begin() + static_cast<std::ptrdiff_t>(first + size));
    const Value along = inner_product(whitened, mean);
    const Value inverse_along = inner_product(twice, mean);
    const Value lessened = along - less * inverse_along;
    const double b = std::abs(lessened);
    const double r = best_gain(a, b, dimension);
    const Value turn = b > 0.0 ? std::conj(lessened) / b : 1.0;
    // |r y - mu|^2 in both metrics.
    const auto misfit = [&](double of_y, const Value& of_both, float of_mu) {
      return std::max(r * r * of_y - 2.0 * r * (turn * of_both).real() + static_cast<double>(of_mu),
                      kMinPower);
    };
    const double left = misfit(power, along, of_mean.whitened);
    const double inverse_left = misfit(inverse_power, inverse_along, of_mean.inverse);
    best = std::max(best,
                    2.0 * dimension * std::log(r) - left / (1.0 + noise * inverse_left / left) +
                        (is_obstructed ? kLogObstructed : 0.0));
  }
  return best - place.log_determinant - dimension * std::log1p(noise * trace / dimension);
}

ModelError with_noise(ModelError error, const ObservedArray& observed) {
  error.noise += observed.noise;
  return error;
}

}  // namespace rayloc
