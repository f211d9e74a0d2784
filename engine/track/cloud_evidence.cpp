#include "engine/track/cloud_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/normal_draws.h"
#include "engine/posterior/place_fusion.h"

namespace rayloc {
namespace {

// A count, chosen: boxes of the room that a cloud represents.
constexpr double kBoxesOfCloud = 60.0;
// A share, chosen: a small room is still compared with its sample.
constexpr double kMaxShareOfCloud = 0.5;
constexpr double kOfThisMoment = 0.1;    // a share, chosen: a mean is smoothed over ten moments
constexpr float kMaxExponent = 60.0F;    // a logarithm, chosen: sums of factors remain finite
constexpr std::size_t kPlacesOfBox = 8;  // a count, chosen: of a box of the sample
constexpr double kApart = 0.022;      // [m], chosen: of such a place from the middle, x and y ...
constexpr double kApartUp = 0.03;     // [m], ... and z
constexpr double kWithinCell = 0.45;  // a share, chosen: it remains inside a narrow box

struct SamplePlaces {
  static constexpr std::size_t kCount = kBoxesOfMoment * kPlacesOfBox;
  std::array<float, kCount> x;
  std::array<float, kCount> y;
  std::array<float, kCount> z;
  std::array<std::uint32_t, kCount> box;

  SearchedPlaces all() const { return {x, y, z, box}; }
};

// The boxes of a moment follow from its time alone.
SamplePlaces sample_of(const CloudRoom& room, Timestamp time) {
  const auto number = static_cast<std::uint64_t>(time.time_since_epoch().count());
  const std::size_t first = mixed(number) % (kSampleBoxes / kBoxesOfMoment) * kBoxesOfMoment;
  const Grid& grid = room.lattice.grid();
  const double x = std::min(kApart, kWithinCell * grid.step_x);
  const double y = std::min(kApart, kWithinCell * grid.step_y);
  const double z = room.lattice.is_height_known() ? 0.0 : kApartUp;
  SamplePlaces places;
  for (std::size_t n = 0; n < SamplePlaces::kCount; ++n) {
    const CloudRoom::SampleBox& one = room.sample[first + n / kPlacesOfBox];
    places.x[n] = static_cast<float>(one.middle.x + ((n & 1U) != 0 ? x : -x));
    places.y[n] = static_cast<float>(one.middle.y + ((n & 2U) != 0 ? y : -y));
    places.z[n] = static_cast<float>(one.middle.z + ((n & 4U) != 0 ? z : -z));
    places.box[n] = one.box;
  }
  return places;
}

float largest(const std::vector<float>& values) {
  return *std::max_element(values.begin(), values.end());
}

}  // namespace

CloudEvidence::CloudEvidence(std::shared_ptr<const CloudRoom> room, Compare compare)
    : room_(std::move(room)),
      compare_(std::move(compare)),
      exponent_(room_->localizer->room().likelihood_exponent) {
  RAYLOC_CHECK(room_->sample.size() == kSampleBoxes);
}

// Without the arrays that no place explains.
CloudEvidence::Compared CloudEvidence::compared(const RoomObservation& observation,
                                                const PlaceCloud& cloud,
                                                std::span<const std::uint32_t> boxes) const {
  const SearchedPlaces places{cloud.x(), cloud.y(), cloud.z(), boxes};
  const SamplePlaces sample = sample_of(*room_, observation.estimate.time);
  Compared values;
  if (compare_) {
    values.cloud = compare_(observation, places, PlaceSearch::Spread::kTogether);
    values.sample = compare_(observation, sample.all(), PlaceSearch::Spread::kApart);
  } else {
    PlaceSearch search(observation, exponent_);
    values.cloud = search.log_likelihoods(places, PlaceSearch::Spread::kTogether);
    values.sample = search.log_likelihoods(sample.all(), PlaceSearch::Spread::kApart);
  }
  values.places = cloud.size();
  RAYLOC_CHECK(values.cloud.size() == observation.arrays.size() &&
               values.sample.size() == observation.arrays.size());
  for (const ArrayObservation& one : observation.arrays) {
    values.ap.push_back(one.ap);
  }
  for (std::size_t i = values.ap.size(); i-- > 0;) {
    if (largest(values.cloud[i]) <= 0.0F && largest(values.sample[i]) <= 0.0F) {
      const auto at = static_cast<std::ptrdiff_t>(i);
      values.ap.erase(values.ap.begin() + at);
      values.cloud.erase(values.cloud.begin() + at);
      values.sample.erase(values.sample.begin() + at);
    }
  }
  return values;
}

// ln of the mean of exp(exponent l) over the room.
double CloudEvidence::log_mean(std::span<const float> cloud,
                               std::span<const float> sample,
                               std::size_t places,
                               double exponent) const {
  const double share = std::min(kMaxShareOfCloud, kBoxesOfCloud / room_->boxes);
  const double of_cloud = std::log(share) + log_mean_of(cloud, places, exponent);
  const double of_sample = std::log1p(-share) + log_mean_of(sample, sample.size(), exponent);
  return std::isfinite(of_cloud) ? log_add(of_sample, of_cloud) : of_sample;
}

std::vector<CloudEvidence::Terms> CloudEvidence::log_means(const Compared& values) const {
  std::vector<Terms> result;
  for (std::size_t i = 0; i < values.ap.size(); ++i) {
    const auto mean = [&](double e) {
      return log_mean(values.cloud[i], values.sample[i], values.places, e * exponent_);
    };
    Terms& terms = result.emplace_back();
    terms[0] = mean(1.0);
    for (std::size_t k = 0; k < kBlunted.size(); ++k) {
      terms[1 + k] = mean(kBlunted[k].exponent);
    }
  }
  return result;
}

AccessPointFusion CloudEvidence::fusion_of(const std::vector<Terms>& means) const {
  const std::vector<double> faulty(means.size(), room_->localizer->options().faults.access_point);
  return AccessPointFusion::of_means(means, exponent_, faulty);
}

CloudEvidence::Fused CloudEvidence::fused(const Compared& values,
                                          const AccessPointFusion& fusion) const {
  return {fused_log_likelihood(values.cloud, fusion, exponent_),
          fused_log_likelihood(values.sample, fusion, exponent_)};
}

std::vector<CloudEvidence::Terms> CloudEvidence::smoothed(const Compared& values,
                                                          const std::vector<Terms>& now) const {
  std::vector<Terms> result = now;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::size_t ap = values.ap[i];
    if (ap >= log_mean_.size() || !log_mean_[ap]) {
      continue;
    }
    for (std::size_t k = 0; k < result[i].size(); ++k) {
      result[i][k] = log_add(std::log(kOfThisMoment) + now[i][k],
                             std::log1p(-kOfThisMoment) + (*log_mean_[ap])[k]);
    }
  }
  return result;
}

// With the means of this moment: all access points may be received worse than before.
double CloudEvidence::outlier(const Compared& values, const std::vector<Terms>& now) const {
  const AccessPointFusion fusion = fusion_of(now);
  const Fused l = fused(values, fusion);
  return fusion.outlier(log_mean(l.cloud, l.sample, values.places, exponent_),
                        room_->localizer->options().faults.outlier);
}

std::optional<CloudEvidence::Weights> CloudEvidence::weigh(const RoomObservation& observation,
                                                           const PlaceCloud& cloud,
                                                           std::span<const std::uint32_t> boxes,
                                                           double weight) {
  RAYLOC_CHECK(boxes.size() == cloud.size() && weight > 0.0 && weight <= 1.0);
  RAYLOC_CHECK(!observation.arrays.empty());
  const auto has_box = [](std::uint32_t box) { return box != BoxLattice::kNone; };
  if (std::none_of(boxes.begin(), boxes.end(), has_box)) {
    return std::nullopt;
  }
  const Compared values = compared(observation, cloud, boxes);
  if (values.ap.empty()) {
    return std::nullopt;
  }
  const std::vector<Terms> now = log_means(values);
  const std::vector<Terms> means = smoothed(values, now);
  const Fused l = fused(values, fusion_of(means));
  const double mean = log_mean(l.cloud, l.sample, values.places, weight * exponent_);
  if (!std::isfinite(mean)) {
    return std::nullopt;
  }
  Weights result;
  result.best = largest(l.cloud);
  result.outlier = std::max(kMinOutlier, outlier(values, now));
  const auto o = static_cast<float>(result.outlier);
  const auto by = static_cast<float>(weight * exponent_);
  const auto less = static_cast<float>(mean);
  result.factor.resize(l.cloud.size());
  for (std::size_t i = 0; i < result.factor.size(); ++i) {
    result.factor[i] =
        has_box(boxes[std::min(i, boxes.size() - 1)])
            ? (1.0F - o) * std::exp(std::min(kMaxExponent, by * l.cloud[i] - less)) + o
            : 0.0F;
  }
  for (std::size_t i = 0; i < means.size(); ++i) {
    log_mean_.resize(std::max(log_mean_.size(), values.ap[i] + 1));
    log_mean_[values.ap[i]] = means[i];
  }
  return result;
}

}  // namespace rayloc
