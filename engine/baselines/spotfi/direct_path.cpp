#include "engine/baselines/spotfi/direct_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Core>

#include "engine/baselines/paths/gaussian_mixture.h"
#include "engine/baselines/paths/living_line.h"
#include "engine/baselines/paths/music.h"
#include "engine/baselines/paths/sanitise.h"
#include "engine/baselines/paths/smoothed_csi.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr double kDelayUnit = 100e-9;  // [s], so that delays and phases have similar magnitude

// Up to `most` frames of one access point, evenly spaced.
std::vector<const CsiFrame*> chosen(std::span<const CsiFrame> frames,
                                    std::size_t access_point,
                                    std::size_t most) {
  std::vector<const CsiFrame*> own;
  for (const CsiFrame& frame : frames) {
    if (frame.access_point == access_point) {
      own.push_back(&frame);
    }
  }
  if (own.size() <= most) {
    return own;
  }
  std::vector<const CsiFrame*> some;
  for (std::size_t i = 0; i < most; ++i) {
    some.push_back(own[i * own.size() / most]);
  }
  return some;
}

// The cluster that is most likely the direct path.
std::pair<double, double> direct_cluster(const std::vector<PathAtArray>& paths,
                                         const DirectPathOptions& options,
                                         std::uint64_t seed) {
  Eigen::MatrixXd points(3, static_cast<Eigen::Index>(paths.size()));
  for (std::size_t i = 0; i < paths.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) << std::cos(paths[i].psi), std::sin(paths[i].psi),
        paths[i].tau / kDelayUnit;
  }
  MixtureOptions mixture;
  mixture.components = options.clusters;
  mixture.seed = seed;
  std::pair<double, double> best = {0.0, -1.0};
  for (const MixtureComponent& cluster : fit_mixture(points, mixture).components) {
    const double psi_deviation =
        std::sqrt(cluster.variance(0) + cluster.variance(1)) / std::numbers::pi;
    const double likelihood =
        std::exp(options.w_share * cluster.share - options.w_psi * psi_deviation -
                 options.w_tau * std::sqrt(cluster.variance(2)) - options.w_soon * cluster.mean(2));
    if (likelihood > best.second) {
      best = {std::atan2(cluster.mean(1), cluster.mean(0)), likelihood};
    }
  }
  return best;
}

struct FramePaths {
  const AntennaLine& line;
  PathCountRule count;
};

// The paths of each usable frame.
std::vector<PathAtArray> paths_of_frames(const RoomModel& room,
                                         std::size_t access_point,
                                         const ToneComb& comb,
                                         const std::vector<const CsiFrame*>& frames,
                                         const FramePaths& how) {
  std::vector<PathAtArray> all;
  std::vector<std::string> of_single_frames;  // already reported for the burst
  std::optional<Music> music;
  for (const CsiFrame* frame : frames) {
    const auto single = preprocess_burst(room, access_point, {frame, 1}, {}, of_single_frames);
    if (!single) {
      continue;
    }
    const Eigen::MatrixXcd h = along(how.line, *single, comb.tone);
    if (!music) {
      MusicOptions options;
      options.count = how.count;
      music.emplace(smoothing_window(h), comb.step_hz, options);
    }
    const auto paths = music->paths(sanitised(h));
    all.insert(all.end(), paths.begin(), paths.end());
  }
  return all;
}

}  // namespace

std::optional<DirectPath> find_direct_path(const RoomModel& room,
                                           std::size_t access_point,
                                           std::span<const CsiFrame> frames,
                                           const DirectPathSearch& search,
                                           std::vector<std::string>& warnings) {
  auto burst = preprocess_burst(room, access_point, frames, {}, warnings);
  if (!burst) {
    return std::nullopt;
  }
  auto line = living_line(room.access_points[access_point], *burst, warnings);
  if (!line) {
    return std::nullopt;
  }
  const auto all = paths_of_frames(room,
                                   access_point,
                                   search.comb,
                                   chosen(frames, access_point, search.options.frames),
                                   {*line, search.options.count});
  if (all.empty()) {
    warnings.push_back(room.access_points[access_point].id + ": no single frame can be used");
    return std::nullopt;
  }
  const auto [psi, likelihood] = direct_cluster(all, search.options, search.seed);
  return DirectPath{psi, likelihood, *std::move(line), *std::move(burst)};
}

}  // namespace rayloc
