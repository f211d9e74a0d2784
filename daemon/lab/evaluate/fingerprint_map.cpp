#include "daemon/lab/evaluate/fingerprint_map.h"

#include <algorithm>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/observe/burst.h"

namespace rayloc {

FingerprintMap::FingerprintMap(const OfdmGrid& grid, std::vector<AccessPoint> access_points)
    : grid_(grid), access_points_(std::move(access_points)), aligner_(grid) {}

std::optional<FingerprintMap::Fingerprint> FingerprintMap::take(
    std::span<const CsiFrame> frames) const {
  Fingerprint fingerprint;
  bool is_received = false;
  for (const AccessPoint& ap : access_points_) {
    auto burst = combine_burst(frames, {ap.index, grid_, ap.rx_chains, {}});
    is_received = is_received || burst.has_value();
    fingerprint.push_back(burst ? std::move(burst->h) : std::vector<std::complex<double>>());
  }
  return is_received ? std::optional(std::move(fingerprint)) : std::nullopt;
}

bool FingerprintMap::add(const Vec3d& position, std::span<const CsiFrame> frames) {
  auto fingerprint = take(frames);
  if (!fingerprint) {
    return false;
  }
  points_.push_back({position, *std::move(fingerprint)});
  return true;
}

double FingerprintMap::distance(const Fingerprint& a, const Fingerprint& b) const {
  double sum = 0.0;
  for (std::size_t ap = 0; ap < access_points_.size(); ++ap) {
    if (!a[ap].empty() && !b[ap].empty()) {
      sum += 1.0 - aligner_.align(a[ap], b[ap]).correlation;
    } else if (a[ap].empty() != b[ap].empty()) {
      sum += 1.0;
    }
  }
  return sum;
}

std::optional<Vec3d> FingerprintMap::nearest(std::span<const CsiFrame> frames) const {
  const auto fingerprint = take(frames);
  if (!fingerprint || points_.empty()) {
    return std::nullopt;
  }
  std::vector<double> distances(points_.size());
  parallel_for(points_.size(), 8, [&](std::size_t i) {
    distances[i] = distance(points_[i].fingerprint, *fingerprint);
  });
  const auto best = std::min_element(distances.begin(), distances.end());
  return points_[static_cast<std::size_t>(best - distances.begin())].position;
}

}  // namespace rayloc
