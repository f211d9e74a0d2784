#include "engine/person/person_scattering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/constants.h"
#include "engine/room/surface_correction.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

// Rays below this share of free space over the link's distance are left out (scattering.h).
constexpr double kNegligible = 1e-3;
// Largest change of a ray's strength over a metre: a ray at a shadow edge of the room fades over
// centimetres, and its logarithm has no useful slope.
constexpr double kMaxGrowth = 10.0;

// Rays to two antennas over the same surfaces before and behind the body are one path if their
// departures agree to this. A cosine, 8 degrees, chosen: arrays are small beside their distance.
constexpr double kSamePath = 0.99;

// The paths of an array's rays, numbered in order of occurrence.
class PathNumbers {
 public:
  std::size_t number(const Path& path) {
    const auto same = std::find_if(paths_.begin(), paths_.end(), [&](const Path& other) {
      return dot(other.departure, path.departure) > kSamePath &&
             std::equal(other.interactions.begin(),
                        other.interactions.end(),
                        path.interactions.begin(),
                        path.interactions.end(),
                        [](const Interaction& a, const Interaction& b) {
                          return a.kind == b.kind && a.surface == b.surface;
                        });
    });
    if (same != paths_.end()) {
      return static_cast<std::size_t>(same - paths_.begin());
    }
    paths_.push_back(path);
    return paths_.size() - 1;
  }

 private:
  std::vector<Path> paths_;
};

Value log_slope(const PathDerivatives::Derivative& slope, const Value& a, double angular_carrier) {
  const Value relative = Value(slope.a.re, slope.a.im) / a;
  return {std::clamp(relative.real(), -kMaxGrowth, kMaxGrowth),
          relative.imag() - angular_carrier * slope.tau};
}

}  // namespace

ScatteredRays moved_transmitter(ScatteredRays rays, const Vec3d& shift) {
  for (auto& element : rays) {
    for (ScatteredRay& ray : element) {
      ray.length -= dot(ray.departure, shift);
    }
  }
  return rays;
}

PersonScattering::PersonScattering(const RoomModel& room, std::vector<TargetLink> links)
    : links_(std::move(links)),
      correction_(room.surface_correction),
      angular_carrier_(2.0 * std::numbers::pi * room.grid.centre_hz) {}

Expected<PersonScattering> PersonScattering::create(const RoomModel& room,
                                                    std::size_t access_point,
                                                    const Transmitter& transmitter,
                                                    const TargetBody& body,
                                                    int depth) {
  ScatteringOptions options;
  options.trace = room.trace;
  options.trace.max_depth = std::min(depth, room.trace.max_depth);
  options.trace.transmission = false;
  options.negligible = kNegligible;
  const auto tracer = TargetTracer::create(room.scene, body, options);
  RAYLOC_TRY(tracer);
  const auto elements = array_elements<Receiver>(room.access_points[access_point].array);
  return PersonScattering(room, tracer->links(transmitter, elements));
}

std::optional<ScatteredRays> PersonScattering::at(const TargetPosition& place) const {
  ScatteredRays rays(links_.size());
  PathNumbers path_numbers;
  for (std::size_t element = 0; element < links_.size(); ++element) {
    const auto found = links_[element].differentiate(place);
    if (!found) {
      return std::nullopt;
    }
    rays[element].reserve(found->paths.size());
    for (std::size_t i = 0; i < found->paths.size(); ++i) {
      const Path& path = found->paths[i];
      const Value a(path.a.re, path.a.im);
      if (std::norm(a) <= 0.0) {
        continue;
      }
      const ScatteredRay ray{apply_surface_correction(correction_, path, a),
                             path.tau * kSpeedOfLight,
                             log_slope(found->by_position.at(i, 0), a, angular_carrier_),
                             log_slope(found->by_position.at(i, 1), a, angular_carrier_),
                             path.departure,
                             path_numbers.number(path)};
      rays[element].push_back(ray);
    }
  }
  return rays;
}

std::optional<std::vector<TargetPaths>> PersonScattering::paths(const TargetPosition& place) const {
  std::vector<TargetPaths> result;
  result.reserve(links_.size());
  for (const TargetLink& link : links_) {
    auto found = link.differentiate(place);
    if (!found) {
      return std::nullopt;
    }
    correct_paths(correction_, found->paths, found->by_position);
    result.push_back(*std::move(found));
  }
  return result;
}

}  // namespace rayloc
