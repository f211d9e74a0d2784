#include "engine/calibrate/survey_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

// The weight of an even spread over the room, relative to one more sighting of a surface: it
// decides between points with equal sightings, and alone when all surfaces have enough.
constexpr double kSpreadWeight = 0.05;
constexpr double kSpreadReach = 1.0;  // [m]

// A visible reflection: position in the list of sightings, and its band of incidence.
struct Sighting {
  std::uint32_t pair;
  std::uint32_t band;
  friend auto operator<=>(const Sighting&, const Sighting&) = default;
};

struct SurveyCandidate {
  Vec3d position;
  std::vector<Sighting> seen;  // ascending, without repetition
};

bool is_clear(const Scene& scene, const Vec3d& p, double clearance) {
  constexpr int kDirections = 16;  // a count, chosen: 22.5 degrees apart
  for (int i = 0; i < kDirections; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / kDirections;
    if (scene.is_blocked({p, p + clearance * Vec3d{std::cos(phi), std::sin(phi), 0.0}})) {
      return false;
    }
  }
  return true;
}

std::vector<Vec3d> free_places(const RoomModel& room, const SurveyPlanOptions& options) {
  const Vec3d size = room.bounds_max - room.bounds_min;
  const double spacing =
      std::max(options.spacing, std::sqrt(size.x * size.y / double{kMaxCandidates}));
  // Cells of equal size; the places are their centres.
  const auto columns = static_cast<int>(std::max(1.0, std::floor(size.x / spacing)));
  const auto rows = static_cast<int>(std::max(1.0, std::floor(size.y / spacing)));
  std::vector<Vec3d> places;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vec3d p{room.bounds_min.x + (column + 0.5) * size.x / columns,
                    room.bounds_min.y + (row + 0.5) * size.y / rows,
                    room.device.height};
      const bool far = std::all_of(
          room.access_points.begin(), room.access_points.end(), [&](const RoomAccessPoint& ap) {
            return norm(ap.array.pose.position - p) >= options.antenna_distance;
          });
      if (far && options.is_free(p) && is_clear(*room.scene, p, options.clearance)) {
        places.push_back(p);
      }
    }
  }
  return places;
}

std::uint32_t band_of(const Vec3d& normal, const Vec3d& arriving) {
  const double cosine = std::min(1.0, std::abs(dot(normal, arriving)));
  const double share = std::acos(cosine) / (0.5 * std::numbers::pi);
  return static_cast<std::uint32_t>(
      std::min<double>(kIncidenceBands - 1, std::floor(share * kIncidenceBands)));
}

// The reflections of the relevant paths: surface and band of incidence.
std::vector<std::pair<std::uint32_t, std::uint32_t>> reflections(const Scene& scene,
                                                                 const Vec3d& from,
                                                                 const Paths& paths,
                                                                 double range_db) {
  double strongest = 0.0;
  for (const Path& path : paths) {
    strongest = std::max(strongest, abs2(path.a));
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> met;
  for (const Path& path : paths) {
    if (!(abs2(path.a) > strongest * std::pow(10.0, -0.1 * range_db))) {
      continue;
    }
    Vec3d last = from;
    for (const Interaction& interaction : path.interactions) {
      if (!is_mirror(interaction.kind)) {
        continue;
      }
      const Vec3d segment = interaction.position - last;
      const Vec3d& normal = scene.surfaces()[interaction.surface].plane().normal;
      met.emplace_back(interaction.surface, band_of(normal, (1.0 / norm(segment)) * segment));
      last = interaction.position;
    }
  }
  return met;
}

// Traces all places and numbers their visible pairs of surface and access point.
std::vector<SurveyCandidate> candidates_from(const std::vector<Vec3d>& places,
                                             const RoomModel& room,
                                             const SurveyPlanOptions& options,
                                             std::vector<SurfaceSightings>& sightings) {
  using Met = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  std::vector<std::vector<Met>> met(places.size(), std::vector<Met>(room.access_points.size()));
  const PathTracer tracer(room.scene, {.max_depth = options.max_depth});
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    const ReceiverTracer at_array = tracer.at(array_origin<Receiver>(room.access_points[ap].array));
    parallel_for(places.size(), 8, [&](std::size_t i) {
      const Paths paths = at_array.trace(
          Transmitter{{places[i], {}, room.device.pattern, room.device.polarization}});
      met[i][ap] = reflections(*room.scene, places[i], paths, options.range_db);
    });
  }
  std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> numbers;
  for (const auto& of_place : met) {
    for (std::size_t ap = 0; ap < of_place.size(); ++ap) {
      for (const auto& [surface, band] : of_place[ap]) {
        numbers[{surface, ap}] = 0;
      }
    }
  }
  for (auto& [pair, number] : numbers) {
    number = static_cast<std::uint32_t>(sightings.size());
    sightings.push_back({pair.first, pair.second, 0, 0, {}});
  }
  std::vector<SurveyCandidate> candidates;
  for (std::size_t i = 0; i < places.size(); ++i) {
    SurveyCandidate candidate{places[i], {}};
    for (std::size_t ap = 0; ap < met[i].size(); ++ap) {
      for (const auto& [surface, band] : met[i][ap]) {
        candidate.seen.push_back({numbers[{surface, ap}], band});
      }
    }
    std::sort(candidate.seen.begin(), candidate.seen.end());
    candidate.seen.erase(std::unique(candidate.seen.begin(), candidate.seen.end()),
                         candidate.seen.end());
    if (!candidate.seen.empty()) {
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

// Calls body(pair) once for each pair of surface and access point visible from a candidate.
template <typename Body>
void for_each_pair(const SurveyCandidate& candidate, const Body& body) {
  for (std::size_t i = 0; i < candidate.seen.size(); ++i) {
    if (i == 0 || candidate.seen[i].pair != candidate.seen[i - 1].pair) {
      body(candidate.seen[i].pair);
    }
  }
}

class Greedy {
 public:
  Greedy(const std::vector<SurveyCandidate>& candidates,
         const SurveyPlanOptions& options,
         std::vector<SurfaceSightings>& sightings)
      : candidates_(candidates),
        options_(options),
        sightings_(sightings),
        distance_(candidates.size(), std::numeric_limits<double>::infinity()) {}

  std::vector<Vec3d> take() {
    std::vector<Vec3d> points;
    while (points.size() < std::min(options_.points, candidates_.size())) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < candidates_.size(); ++i) {
        if (value(i) > value(best)) {
          best = i;
        }
      }
      points.push_back(candidates_[best].position);
      add(best);
    }
    return points;
  }

 private:
  // The value of a candidate: one more sighting of each surface, worth less the more it already
  // has, once for their number and once for their spread over the bands.
  double value(std::size_t i) const {
    if (distance_[i] == 0.0) {
      return -1.0;  // taken
    }
    double sum = kSpreadWeight * std::min(distance_[i], kSpreadReach);
    for_each_pair(candidates_[i], [&](std::uint32_t pair) {
      sum += worth(sightings_[pair].points, options_.sightings);
    });
    for (const Sighting& seen : candidates_[i].seen) {
      sum += worth(sightings_[seen.pair].points_in_band.at(seen.band),
                   options_.sightings / kIncidenceBands);
    }
    return sum;
  }

  static double worth(std::size_t had, std::size_t wanted) {
    return had < wanted ? 1.0 / static_cast<double>(1 + had) : 0.0;
  }

  void add(std::size_t taken) {
    for_each_pair(candidates_[taken], [&](std::uint32_t pair) { ++sightings_[pair].points; });
    for (const Sighting& seen : candidates_[taken].seen) {
      ++sightings_[seen.pair].points_in_band[seen.band];
    }
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const double apart = norm(candidates_[i].position - candidates_[taken].position);
      distance_[i] = std::min(distance_[i], apart);
    }
  }

  const std::vector<SurveyCandidate>& candidates_;
  const SurveyPlanOptions& options_;
  std::vector<SurfaceSightings>& sightings_;
  std::vector<double> distance_;  // of each candidate to the nearest taken one
};

void sort_by_nearest(std::vector<Vec3d>& points, Vec3d from) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto next = std::min_element(
        points.begin() + static_cast<std::ptrdiff_t>(i),
        points.end(),
        [&](const Vec3d& a, const Vec3d& b) { return norm(a - from) < norm(b - from); });
    std::swap(points[i], *next);
    from = points[i];
  }
}

// A nearest-neighbour tour leaves some points behind; reversing sections until no reversal shortens
// the tour includes them (2-opt).
std::vector<Vec3d> in_order_to_walk(std::vector<Vec3d> points, const Vec3d& from) {
  constexpr double kShorter = 1e-9;  // [m]
  sort_by_nearest(points, from);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t first = 0; first < points.size(); ++first) {
      for (std::size_t last = first + 1; last < points.size(); ++last) {
        const Vec3d& before = first == 0 ? from : points[first - 1];
        double gain = norm(points[first] - before) - norm(points[last] - before);
        if (last + 1 < points.size()) {
          gain += norm(points[last + 1] - points[last]) - norm(points[last + 1] - points[first]);
        }
        if (gain > kShorter) {
          std::reverse(points.begin() + static_cast<std::ptrdiff_t>(first),
                       points.begin() + static_cast<std::ptrdiff_t>(last) + 1);
          changed = true;
        }
      }
    }
  }
  return points;
}

}  // namespace

SurveyPlan plan_survey(const RoomModel& room, const SurveyPlanOptions& options) {
  SurveyPlan plan;
  const auto candidates =
      candidates_from(free_places(room, options), room, options, plan.sightings);
  plan.candidates = candidates.size();
  for (const SurveyCandidate& candidate : candidates) {
    for_each_pair(candidate, [&](std::uint32_t pair) { ++plan.sightings[pair].candidates; });
  }
  plan.points =
      in_order_to_walk(Greedy(candidates, options, plan.sightings).take(), room.bounds_min);
  return plan;
}

}  // namespace rayloc
