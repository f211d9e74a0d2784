#include "engine/baselines/m3/m3.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/constants.h"
#include "engine/baselines/m3/reflectors.h"
#include "engine/baselines/paths/turn.h"
#include "engine/baselines/plan_map.h"
#include "engine/baselines/two_pi.h"
#include "engine/observe/alignment.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr int kAlignments = 5;              // of the hops to the paths, a count
constexpr double kMinSigmaTau = 1e-9;       // [s], of a delay after the first path
constexpr double kSigmaOfResolution = 0.1;  // of 1 / band, a ratio
constexpr double kDelays = 70e-9;           // [s], range of the delays of an unknown path

double normal(double x, double sigma) {
  return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * std::sqrt(kTwoPi));
}

// Row-major, as Aligner stores arrays.
using Rows = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::span<std::complex<double>> values(Rows& h) {
  return {h.data(), static_cast<std::size_t>(h.size())};
}

Eigen::MatrixXcd aligned(const OfdmGrid& grid, Rows reference, const Eigen::MatrixXcd& h) {
  Rows value = h;
  const Aligner aligner(grid);
  aligner.apply(aligner.align(values(reference), values(value)), values(value));
  return value;
}

std::string one_decimal(double value) {
  const auto tenths = std::llround(10.0 * value);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
}

// Warnings about the number of channels, and about the resolution of a single one.
void describe_hops(const RoomModel& room,
                   std::span<const M3Received> received,
                   std::vector<std::string>& warnings) {
  const OfdmGrid& site = room.grid;
  bool hops = false;
  for (const M3Received& one : received) {
    hops = hops || one.hops.size() > 1;
  }
  if (!hops) {
    const double width = site.offset_hz(site.size() - 1) - site.offset_hz(0);
    warnings.push_back("m3 without channel hopping: in " + one_decimal(1e-6 * width) +
                       " MHz it separates paths that differ by " +
                       one_decimal(kSpeedOfLight / width) + " m");
  }
  for (const M3Received& one : received) {
    if (hops || one.hops.front().grid.centre_hz != site.centre_hz) {
      warnings.push_back("access point " + room.access_points[one.access_point].id +
                         ": m3 hops over " + std::to_string(one.hops.size()) +
                         (one.hops.size() == 1 ? " channel" : " channels") +
                         ", with the chain gains of the one at " +
                         one_decimal(1e-6 * site.centre_hz) + " MHz in all");
    }
  }
}

// The bearing with the most power over all hops.
double strongest_bearing(const M3Received& received, const SageOptions& options) {
  double best = 0.0;
  double most = -1.0;
  for (std::size_t i = 0; i < options.u_points; ++i) {
    const double u = 2.0 * static_cast<double>(i) / static_cast<double>(options.u_points - 1) - 1.0;
    double sum = 0.0;
    for (const M3Hop& hop : received.hops) {
      const double step = kTwoPi * hop.grid.centre_hz * received.line.spacing * u / kSpeedOfLight;
      Eigen::RowVectorXcd steering(hop.h.rows());
      for (Eigen::Index m = 0; m < hop.h.rows(); ++m) {
        steering(m) = turn(-step * static_cast<double>(m));
      }
      sum += (steering * hop.h).squaredNorm();
    }
    if (sum > most) {
      most = sum;
      best = u;
    }
  }
  return best;
}

}  // namespace

M3::M3(std::shared_ptr<const RoomModel> room, const M3Options& options)
    : room_(std::move(room)), options_(options) {
  for (std::size_t i = 0; i < room_->access_points.size(); ++i) {
    const RoomAccessPoint& ap = room_->access_points[i];
    reflectors_.push_back(reflectors_of(*room_, ap.array.pose.position));
    if (const std::string problem = calibration_problem(*room_, ap); !problem.empty()) {
      warnings_.push_back("access point " + ap.id + " " + problem);
    } else {
      usable_.push_back(i);
    }
  }
}

Expected<M3> M3::create(std::shared_ptr<const RoomModel> room, const M3Options& options) {
  RAYLOC_TRY(check_room(room.get()));
  M3 made(std::move(room), options);
  const auto& mirrors = made.reflectors_.front();
  if (std::none_of(mirrors.begin(), mirrors.end(), is_vertical)) {
    return make_error(ErrorKind::kConfiguration,
                      "no vertical plane of 1 m2 or more of the scene bounds the room: m3 needs "
                      "reflectors at known places");
  }
  return made;
}

M3Paths M3::find_paths(const M3Received& received) const {
  SageOptions options;
  options.paths = options_.paths;
  std::vector<OfdmGrid> grids;
  double lowest = received.hops.front().grid.frequency_hz(0);
  double highest = lowest;
  for (const M3Hop& hop : received.hops) {
    grids.push_back(hop.grid);
    lowest = std::min(lowest, hop.grid.frequency_hz(0));
    highest = std::max(highest, hop.grid.frequency_hz(hop.grid.size() - 1));
  }
  const Sage sage(std::move(grids), received.line.spacing, received.line.element.size(), options);
  std::vector<Eigen::MatrixXcd> h;
  const SagePath alone{strongest_bearing(received, options), 0.0, 1.0};
  for (std::size_t hop = 0; hop < received.hops.size(); ++hop) {
    h.push_back(aligned(sage.hops()[hop], sage.model({&alone, 1}, hop), received.hops[hop].h));
  }
  std::vector<SagePath> paths = sage.paths(h);
  for (int round = 0; round < kAlignments && received.hops.size() > 1; ++round) {
    for (std::size_t hop = 0; hop < h.size(); ++hop) {
      h[hop] = aligned(sage.hops()[hop], sage.model(paths, hop), h[hop]);
    }
    paths = sage.paths(h);
  }
  double most = 0.0;
  for (const SagePath& path : paths) {
    most = std::max(most, std::abs(path.amplitude));
  }
  std::erase_if(paths, [&](const SagePath& path) {
    return std::abs(path.amplitude) < options_.least_amplitude * most;
  });
  std::stable_sort(paths.begin(), paths.end(), [](const SagePath& a, const SagePath& b) {
    return a.tau < b.tau;
  });
  return {received.access_point,
          received.line,
          kSpeedOfLight / received.hops.front().grid.centre_hz,
          highest - lowest,
          std::move(paths)};
}

double M3::log_likelihood(const M3Paths& received, const Vec3d& place) const {
  const AntennaArray& array = room_->access_points[received.access_point].array;
  const Vec3d& at = array.pose.position;
  const double turns =
      kTwoPi * received.line.spacing / received.wavelength;  // [rad], phase of u = 1
  // Difference between the sine of a path and that of a place, for the nearest alias.
  const auto off = [&](double u, const Vec3d& from) {
    return wrapped(turns * u - psi_of(array, received.line, from, received.wavelength)) / turns;
  };
  const SagePath& first = received.paths.front();
  double sum = std::log(normal(off(first.u, place), options_.sigma_u) +
                        normal(4.0 * options_.sigma_u, options_.sigma_u));
  const double sigma_tau = std::max(kMinSigmaTau, kSigmaOfResolution / received.band);
  const auto& mirrors = reflectors_[received.access_point];
  // A phase of a wide array covers only a part of the circle of sines.
  const double anywhere = 1.0 / (std::min(2.0, kTwoPi / turns) * kDelays);
  for (std::size_t i = 1; i < received.paths.size(); ++i) {
    double density = 0.0;
    for (const Plane<double>& mirror : mirrors) {
      if (distance(mirror, place) * distance(mirror, at) <= 0.0) {
        continue;  // the mirror is between them
      }
      const Vec3d image = mirrored(mirror, place);
      const double later = (norm(image - at) - norm(place - at)) / kSpeedOfLight;
      density += normal(off(received.paths[i].u, image), options_.sigma_u_later) *
                 normal(received.paths[i].tau - first.tau - later, sigma_tau);
    }
    sum += std::log(options_.known * density / static_cast<double>(mirrors.size()) +
                    (1.0 - options_.known) * anywhere);
  }
  return sum;
}

void M3::summarise(std::span<const M3Paths> received, LocationEstimate& estimate) const {
  summarise_plan(
      *room_,
      {options_.grid, options_.accuracy_confidence},
      [&](const Vec3d& place) {
        return std::accumulate(
            received.begin(), received.end(), 0.0, [&](double sum, const M3Paths& paths) {
              return sum + log_likelihood(paths, place);
            });
      },
      estimate);
}

LocationEstimate M3::locate(std::span<const CsiFrame> frames) const {
  LocationEstimate estimate;
  estimate.warnings = warnings_;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return estimate;
  }
  const std::vector<ChannelFrames> channels = by_channel(room_->grid, frames);
  ObservationTally tally;
  std::vector<M3Received> received;
  for (const std::size_t i : usable_) {
    if (auto hops = observe_hops(*room_, i, channels, estimate.warnings)) {
      tally.add(room_->access_points[i], hops->burst);
      received.push_back(std::move(hops->received));
    }
  }
  tally.fill(frames, estimate);
  if (received.empty()) {
    estimate.reason = no_usable_csi(*room_, estimate.warnings);
    return estimate;
  }
  describe_hops(*room_, received, estimate.warnings);
  std::vector<M3Paths> paths;
  paths.reserve(received.size());
  for (const M3Received& one : received) {
    paths.push_back(find_paths(one));
  }
  summarise(paths, estimate);
  return estimate;
}

}  // namespace rayloc
