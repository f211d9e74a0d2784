#include "engine/likelihood/ratio_likelihood.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kToneDistance = 2.5e6;  // [Hz]
// Share of the residual that no place lowers: unexplained in calibrated rooms, -20 dB.
constexpr double kFloor = 0.01;
// Above the residual of any place: amplitudes near a null of an antenna vary strongly, so that even
// the true place may fit worse than a constant, and no burst is refused.
constexpr double kWorst = 1e3;

double squared_distance(const std::complex<float>* a,
                        const std::complex<float>* b,
                        std::size_t count) {
  float sum = 0.0F;
  for (std::size_t i = 0; i < count; ++i) {
    const float re = a[i].real() - b[i].real();
    const float im = a[i].imag() - b[i].imag();
    sum += re * re + im * im;
  }
  return static_cast<double>(sum);
}

}  // namespace

RatioLikelihood::RatioLikelihood(LikelihoodKind kind, const OfdmGrid& grid, std::size_t antennas)
    : kind_(kind),
      grid_(grid),
      antennas_(antennas),
      model_(grid, antennas),
      kernel_(grid),
      amplitude_(grid) {
  RAYLOC_CHECK(antennas >= 2 && compares_antennas(kind));
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const bool is_far =
        tones_.empty() ||
        (grid.tone_index[k] - grid.tone_index[tones_.back()]) * grid.spacing_hz >= kToneDistance;
    if (is_far) {
      tones_.push_back(k);
    }
  }
  feature_count_ = (antennas - 1) * tones_.size();
}

std::vector<std::complex<float>> RatioLikelihood::features(std::span<const Value> h) const {
  std::vector<std::complex<float>> result;
  result.reserve(feature_count_);
  const std::size_t tones = grid_.size();
  if (kind_ == LikelihoodKind::kRatioAmplitude) {
    const auto amplitude = amplitude_.of(h);
    for (std::size_t m = 0; m + 1 < antennas_; ++m) {
      for (const std::size_t k : tones_) {
        result.emplace_back(static_cast<float>(amplitude[m * tones + k]), 0.0F);
      }
    }
    return result;
  }
  double power = 0.0;
  for (std::size_t m = 0; m + 1 < antennas_; ++m) {
    for (const std::size_t k : tones_) {
      power += std::norm(h[m * tones + k]) * std::norm(h[(m + 1) * tones + k]);
    }
  }
  const double scale = power > 0.0 ? 1.0 / std::sqrt(power) : 0.0;
  for (std::size_t m = 0; m + 1 < antennas_; ++m) {
    for (const std::size_t k : tones_) {
      result.emplace_back(scale * h[m * tones + k] * std::conj(h[(m + 1) * tones + k]));
    }
  }
  return result;
}

// [antenna][tone], at a place displaced by `moved` from the origin of the rays.
std::vector<Value> RatioLikelihood::expected(const Place& place, const Vec3d& moved) const {
  const std::size_t count = place.rays.size();
  std::vector<double> a_re(count);
  std::vector<double> a_im(count);
  std::vector<double> tau(count);
  for (std::size_t p = 0; p < count; ++p) {
    a_re[p] = place.rays[p].amplitude.real();
    a_im[p] = place.rays[p].amplitude.imag();
  }
  std::vector<Value> h(antennas_ * grid_.size());
  for (std::size_t m = 0; m < antennas_; ++m) {
    for (std::size_t p = 0; p < count; ++p) {
      tau[p] = norm(image_of(place.rays[p], place.element_offset[m]) - moved) / kSpeedOfLight;
    }
    kernel_.forward({a_re, a_im, tau}, std::span(h).subspan(m * grid_.size(), grid_.size()));
  }
  return h;
}

PlaceLikelihood RatioLikelihood::place(const Place& place, const ModelError& /*error*/) const {
  PlaceLikelihood result;
  if (place.rays.empty()) {
    return result;
  }
  RAYLOC_CHECK(place.element_offset.size() == antennas_);
  result.reachable = true;
  const double quarter_wave = 0.25 * kSpeedOfLight / grid_.centre_hz;
  const auto across =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(place.cell_size / quarter_wave)));
  const auto at = [&](std::size_t i) {
    return place.cell_size * ((static_cast<double>(i) + 0.5) / static_cast<double>(across) - 0.5);
  };
  for (std::size_t x = 0; x < across; ++x) {
    for (std::size_t y = 0; y < across; ++y) {
      const auto one = features(expected(place, {at(x), at(y), 0.0}));
      result.features.insert(result.features.end(), one.begin(), one.end());
    }
  }
  return result;
}

ObservedBurst RatioLikelihood::observe(std::span<const Value> h) const {
  ObservedBurst observed{model_.observe(h), features(h), 1.0F};
  if (kind_ == LikelihoodKind::kRatioAmplitude) {
    const std::size_t count = tones_.size();
    float spread = 0.0F;
    for (std::size_t m = 0; m + 1 < antennas_; ++m) {
      const std::complex<float>* pair = observed.features.data() + m * count;
      std::complex<float> mean;
      for (std::size_t k = 0; k < count; ++k) {
        mean += pair[k] / static_cast<float>(count);
      }
      for (std::size_t k = 0; k < count; ++k) {
        spread += std::norm(pair[k] - mean);
      }
    }
    observed.scale = 1.0F / std::max(spread, 1e-12F);
  }
  return observed;
}

// Log-likelihood of e^2 in units of its value without a model.
double RatioLikelihood::of_residual(double share) const {
  const std::size_t coordinates = model_.dimension() / antennas_;
  const std::size_t per_pair =
      kind_ == LikelihoodKind::kRatioComplex ? 2 * coordinates : coordinates;
  return -0.5 * static_cast<double>((antennas_ - 1) * per_pair) * std::log(share + kFloor);
}

// The kind has no delay to search.
Likelihood::Coarse RatioLikelihood::coarse(const PlaceLikelihood& place,
                                           const ObservedBurst& observed) const {
  return {log_likelihood(place, observed, 0), 0};
}

double RatioLikelihood::log_likelihood(const PlaceLikelihood& place,
                                       const ObservedBurst& observed,
                                       std::uint8_t /*windows*/) const {
  if (place.features.empty()) {  // null model, see null_model()
    return of_residual(kWorst);
  }
  const auto scale = static_cast<double>(observed.scale);
  std::vector<double> each;
  for (std::size_t first = 0; first < place.features.size(); first += feature_count_) {
    each.push_back(of_residual(scale * squared_distance(place.features.data() + first,
                                                        observed.features.data(),
                                                        feature_count_)));
  }
  const double top = *std::max_element(each.begin(), each.end());
  double sum = 0.0;
  for (const double one : each) {
    sum += std::exp(one - top);
  }
  return top + std::log(sum / static_cast<double>(each.size()));
}

// place() has already evaluated the places of the cell.
std::unique_ptr<const NearbyLikelihood> RatioLikelihood::nearby(
    const Place& /*place*/,
    const PlaceLikelihood& /*of*/,
    const ModelError& /*error*/,
    const ObservedBurst& /*observed*/) const {
  return nullptr;
}

PlaceLikelihood RatioLikelihood::null_model(const ModelError& /*error*/) const { return {}; }

}  // namespace rayloc
