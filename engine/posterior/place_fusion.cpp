#include "engine/posterior/place_fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Masses, chosen: outside these limits a product in single precision may have lost digits, and
// below this multiple of the mass that carries no information their difference has.
constexpr float kMinProduct = 1e-30F;
constexpr float kMaxProduct = 1e30F;
constexpr float kMinAbove = 1e-2F;

std::vector<LaneRow> rows_of(const std::vector<float>& values) {
  std::vector<LaneRow> rows(values.size() / kLaneCount);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    std::copy_n(values.data() + n * kLaneCount, kLaneCount, rows[n].begin());
  }
  return rows;
}

// No other access point can contradict it.
std::vector<float> of_single(const std::vector<float>& values,
                             const AccessPointFusion& fusion,
                             double likelihood_exponent) {
  const auto add = static_cast<float>(fusion.log_right(0) / likelihood_exponent);
  std::vector<float> result(values.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    result[n] = std::max(kNoMass, values[n] + add);
  }
  return result;
}

}  // namespace

std::vector<FusedArray> fused_arrays(const AccessPointFusion& fusion,
                                     double likelihood_exponent,
                                     std::span<const float> highest) {
  static_assert(kBlunted[0].exponent == 1.0 / 4.0 && kBlunted[1].exponent == 1.0 / 16.0,
                "as of FusedArray");
  RAYLOC_CHECK(highest.size() == fusion.size());
  std::vector<FusedArray> arrays(fusion.size());
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    FusedArray& one = arrays[i];
    one.exponent = static_cast<float>(likelihood_exponent);
    one.shift = one.exponent * highest[i];
    if (fusion.size() == 1) {  // no other access point can contradict it
      one.right = static_cast<float>(std::exp(fusion.log_right(i)));
      continue;
    }
    const auto shift = static_cast<double>(one.shift);
    const AccessPointFusion::Terms& factor = fusion.log_factor(i);
    one.right = static_cast<float>(std::exp(factor[0]));
    one.quarter = static_cast<float>(std::exp(factor[1] - (1.0 - kBlunted[0].exponent) * shift));
    one.sixteenth = static_cast<float>(std::exp(factor[2] - (1.0 - kBlunted[1].exponent) * shift));
    one.wrong = static_cast<float>(std::exp(fusion.log_wrong(i) - shift));
  }
  return arrays;
}

std::vector<float> fused_log_likelihood(std::span<const std::vector<float>> values,
                                        const AccessPointFusion& fusion,
                                        double likelihood_exponent) {
  RAYLOC_CHECK(values.size() == fusion.size());
  const std::size_t places = values.front().size();
  RAYLOC_CHECK(places > 0 && places % kLaneCount == 0);
  if (values.size() == 1) {
    return of_single(values.front(), fusion, likelihood_exponent);
  }
  std::vector<float> highest;
  std::vector<std::vector<LaneRow>> rows;
  for (const std::vector<float>& one : values) {
    RAYLOC_CHECK(one.size() == places);
    highest.push_back(*std::max_element(one.begin(), one.end()));
    rows.push_back(rows_of(one));
  }
  std::vector<FusedArray> arrays = fused_arrays(fusion, likelihood_exponent, highest);
  double log_scale = 0.0;
  float nothing = 1.0F;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    arrays[i].log_likelihood = rows[i];
    log_scale += static_cast<double>(arrays[i].shift);
    nothing *= arrays[i].wrong;
  }
  std::vector<LaneRow> mass(places / kLaneCount);
  fuse_rows(arrays, mass);
  const float least = std::max(kMinProduct, kMinAbove * nothing);
  const auto scale = static_cast<float>(log_scale / likelihood_exponent);
  const auto inverse = static_cast<float>(1.0 / likelihood_exponent);
  std::vector<float> result(places);
  std::vector<double> of_each(values.size());
  for (std::size_t n = 0; n < places; ++n) {
    const float of_place = mass[n / kLaneCount][n % kLaneCount];
    if (values.front()[n] <= kNoMass) {
      result[n] = kNoMass;
    } else if (of_place > least && of_place < kMaxProduct) {
      result[n] = scale + inverse * std::log(of_place);
    } else {
      for (std::size_t i = 0; i < values.size(); ++i) {
        of_each[i] = static_cast<double>(values[i][n]);
      }
      result[n] = static_cast<float>(fusion.log_likelihood(of_each));
    }
    result[n] = std::max(result[n], kNoMass);
  }
  return result;
}

double log_mean_of(std::span<const float> log_likelihood, std::size_t count, double exponent) {
  RAYLOC_CHECK(count > 0 && count <= log_likelihood.size());
  const std::span<const float> values = log_likelihood.first(count);
  const float top = *std::max_element(values.begin(), values.end());
  if (top <= kNoMass) {
    return -std::numeric_limits<double>::infinity();
  }
  const auto by = static_cast<float>(exponent);
  double sum = 0.0;
  for (const float value : values) {
    sum += value > kNoMass ? static_cast<double>(std::exp(by * (value - top))) : 0.0;
  }
  return exponent * static_cast<double>(top) + std::log(sum / static_cast<double>(count));
}

}  // namespace rayloc
