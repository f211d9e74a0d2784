#include "engine/baselines/spotfi/direct_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Core>

#include "engine/baselines/paths/gaussian_mixture.h"
#include "engine/baselines/paths/music.h"
#include "engine/baselines/paths/sanitise.h"
#include "engine/baselines/paths/smoothed_csi.h"
#include "engine/room/hear_burst.h"

namespace rayloc {
namespace {

constexpr double kDelayUnit = 100e-9;  // [s], so that delays and phases are numbers of one size

// [antenna of the line][tone of the comb].
Eigen::MatrixXcd on_comb(const BurstObservation& burst,
                         const AntennaLine& line,
                         const ToneComb& comb) {
  Eigen::MatrixXcd h(static_cast<Eigen::Index>(line.element.size()),
                     static_cast<Eigen::Index>(comb.tone.size()));
  for (std::size_t m = 0; m < line.element.size(); ++m) {
    for (std::size_t k = 0; k < comb.tone.size(); ++k) {
      h(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(k)) =
          burst.value(line.element[m], comb.tone[k]);
    }
  }
  return h;
}

// The frames of one access point, evenly from all.
std::vector<const CsiFrame*> chosen(std::span<const CsiFrame> frames,
                                    std::size_t access_point,
                                    std::size_t most) {
  std::vector<const CsiFrame*> own;
  for (const CsiFrame& frame : frames) {
    if (frame.access_point == static_cast<int>(access_point)) {
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

// The antennas that can be used, of an array whose chains are alive.
std::optional<AntennaLine> living_line(const RoomAccessPoint& ap,
                                       const BurstObservation& burst,
                                       std::vector<std::string>& warnings) {
  std::vector<std::size_t> elements(ap.cores.size());
  std::iota(elements.begin(), elements.end(), std::size_t{0});
  if (const auto dead = dead_chain(burst)) {
    elements.erase(elements.begin() + static_cast<std::ptrdiff_t>(dead->row));
  }
  if (elements.size() < 2) {
    warnings.push_back(ap.id + " has " + std::to_string(elements.size()) +
                       " usable antenna: a bearing needs 2");
    return std::nullopt;
  }
  auto line = antenna_line(ap.array, std::move(elements));
  if (!line) {
    warnings.push_back(ap.id +
                       ": its antennas are not a line of equal steps along its y: no "
                       "bearing");
  }
  return line;
}

// Of all clusters the most likely direct path.
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

}  // namespace

std::optional<DirectPath> find_direct_path(const RoomModel& room,
                                           std::size_t access_point,
                                           const ToneComb& comb,
                                           std::span<const CsiFrame> frames,
                                           const DirectPathOptions& options,
                                           std::uint64_t seed,
                                           std::vector<std::string>& warnings) {
  auto burst = hear(room, access_point, frames, {}, warnings);
  if (!burst) {
    return std::nullopt;
  }
  auto line = living_line(room.access_points[access_point], *burst, warnings);
  if (!line) {
    return std::nullopt;
  }
  std::vector<PathAtArray> all;
  std::vector<std::string> of_single_frames;  // the burst's have said it
  std::optional<Music> music;
  for (const CsiFrame* frame : chosen(frames, access_point, options.frames)) {
    const auto single = hear(room, access_point, {frame, 1}, {}, of_single_frames);
    if (!single) {
      continue;
    }
    const Eigen::MatrixXcd h = on_comb(*single, *line, comb);
    if (!music) {
      MusicOptions how;
      how.count = options.count;
      music.emplace(smoothing_window(h), comb.step_hz, how);
    }
    const auto paths = music->paths(sanitised(h));
    all.insert(all.end(), paths.begin(), paths.end());
  }
  if (all.empty()) {
    warnings.push_back(room.access_points[access_point].id + ": no single frame can be used");
    return std::nullopt;
  }
  const auto [psi, likelihood] = direct_cluster(all, options, seed);
  return DirectPath{psi, likelihood, *std::move(line), *std::move(burst)};
}

}  // namespace rayloc
