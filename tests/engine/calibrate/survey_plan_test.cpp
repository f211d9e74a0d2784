#include "engine/calibrate/survey_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::survey_plan_test {
namespace {

using Pair = std::pair<std::uint32_t, std::size_t>;   // surface, access point
using Seen = std::set<std::pair<Pair, std::size_t>>;  // and a band of incidence

// Which surfaces a place sees in reflections to which access point, and at which angles: by trees
// of its own.
Seen seen_from(const RoomModel& room, const Vec3d& place, int depth, double range_db) {
  Seen seen;
  const PathTracer tracer(room.scene, {.max_depth = depth});
  const Transmitter device{{place, {}, room.device.pattern, room.device.polarization}};
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    const auto receiver = array_origin<Receiver>(room.access_points[ap].array);
    const Paths paths = tracer.trace(device, receiver);
    double strongest = 0.0;
    for (const Path& path : paths) {
      strongest = std::max(strongest, abs2(path.a));
    }
    for (const Path& path : paths) {
      if (10.0 * std::log10(abs2(path.a) / strongest) > -range_db) {
        // From the receiver's end: both ends see the same angle of incidence.
        for (std::size_t i = 0; i < path.interactions.size(); ++i) {
          const bool last = i + 1 == path.interactions.size();
          const Vec3d& at = path.interactions[i].position;
          const Vec3d leaving = (last ? receiver.position : path.interactions[i + 1].position) - at;
          const Vec3d& normal = room.scene->surfaces()[path.interactions[i].surface].plane().normal;
          const double off = std::asin(norm(cross(leaving, normal)) / norm(leaving));
          seen.insert({{path.interactions[i].surface, ap},
                       static_cast<std::size_t>(off * 180.0 / std::numbers::pi / 30.0)});
        }
      }
    }
  }
  return seen;
}

double distance_from_walls(const RoomModel& room, const Vec3d& p) {
  return std::min({p.x - room.bounds_min.x,
                   room.bounds_max.x - p.x,
                   p.y - room.bounds_min.y,
                   room.bounds_max.y - p.y});
}

TEST(SurveyPlan, KeepsItsDistances) {
  const RoomModel room = test::make_room();
  SurveyPlanOptions options;
  options.spacing = 0.1;
  options.clearance = 0.3;
  options.points = 100;
  const SurveyPlan plan = plan_survey(room, options);
  ASSERT_EQ(plan.points.size(), 100U);
  for (const Vec3d& point : plan.points) {
    EXPECT_GE(distance_from_walls(room, point), 0.3 * std::cos(std::numbers::pi / 16.0));
    EXPECT_EQ(point.z, room.device.height);
    for (const RoomAccessPoint& ap : room.access_points) {
      EXPECT_GE(norm(ap.array.pose.position - point), options.antenna_distance);
    }
  }
}

TEST(SurveyPlan, NoPointComesTwice) {
  SurveyPlan plan = plan_survey(test::make_room(), {.points = 1000});
  EXPECT_EQ(plan.points.size(), plan.candidates) << "all there are";
  std::sort(plan.points.begin(), plan.points.end(), [](const Vec3d& a, const Vec3d& b) {
    return std::pair(a.x, a.y) < std::pair(b.x, b.y);
  });
  EXPECT_EQ(std::adjacent_find(plan.points.begin(), plan.points.end()), plan.points.end());
}

TEST(SurveyPlan, CountsTheReflectionsThatTheTracerGives) {
  const RoomModel room = test::make_room();
  const SurveyPlanOptions options{.points = 12};
  const SurveyPlan plan = plan_survey(room, options);
  std::map<std::pair<Pair, std::size_t>, std::size_t> in_band;
  std::map<Pair, std::size_t> counts;
  for (const Vec3d& point : plan.points) {
    std::set<Pair> pairs;
    for (const auto& seen : seen_from(room, point, options.max_depth, options.range_db)) {
      ++in_band[seen];
      pairs.insert(seen.first);
    }
    for (const Pair& pair : pairs) {
      ++counts[pair];
    }
  }
  ASSERT_FALSE(plan.sightings.empty());
  for (const SurfaceSightings& seen : plan.sightings) {
    const Pair pair{seen.surface, seen.access_point};
    EXPECT_EQ(seen.points, counts[pair]) << seen.surface;
    EXPECT_LE(seen.points, seen.candidates);
    for (std::size_t band = 0; band < kIncidenceBands; ++band) {
      EXPECT_EQ(seen.points_in_band.at(band), (in_band[{pair, band}])) << seen.surface;
    }
  }
}

TEST(SurveyPlan, EverySurfaceIsSeenAsOftenAsItCanBe) {
  const RoomModel room = test::make_room();
  const SurveyPlanOptions options{.points = 30};
  const SurveyPlan plan = plan_survey(room, options);
  for (const SurfaceSightings& seen : plan.sightings) {
    EXPECT_GE(seen.points, std::min(options.sightings, seen.candidates)) << seen.surface;
  }
}

// How many sightings some points give, up to a third of the number wanted in each band of
// incidence.
std::size_t useful_sightings(const RoomModel& room,
                             const std::vector<Vec3d>& points,
                             const SurveyPlanOptions& options) {
  std::map<std::pair<Pair, std::size_t>, std::size_t> counts;
  for (const Vec3d& point : points) {
    for (const auto& seen : seen_from(room, point, options.max_depth, options.range_db)) {
      ++counts[seen];
    }
  }
  std::size_t useful = 0;
  for (const auto& [seen, count] : counts) {
    useful += std::min(count, options.sightings / kIncidenceBands);
  }
  return useful;
}

TEST(SurveyPlan, CoversMoreThanRandomPoints) {
  const RoomModel room = test::make_room();
  const SurveyPlanOptions options{.points = 8};
  const auto planned = useful_sightings(room, plan_survey(room, options).points, options);
  std::vector<Vec3d> all = plan_survey(room, {.points = 1000}).points;
  std::mt19937 random(3);
  for (int draw = 0; draw < 20; ++draw) {
    std::shuffle(all.begin(), all.end(), random);
    const std::vector<Vec3d> lot(all.begin(), all.begin() + 8);
    EXPECT_GE(planned, useful_sightings(room, lot, options));
  }
}

TEST(SurveyPlan, UsesOnlyFreePositions) {
  SurveyPlanOptions options{.points = 20};
  options.is_free = [](const Vec3d& p) { return p.x < 0.0; };
  const SurveyPlan plan = plan_survey(test::make_room(), options);
  EXPECT_EQ(plan.points.size(), 20U);
  for (const Vec3d& point : plan.points) {
    EXPECT_LT(point.x, 0.0);
  }
  options.is_free = [](const Vec3d&) { return false; };
  EXPECT_TRUE(plan_survey(test::make_room(), options).points.empty());
}

double length_of(Vec3d from, const std::vector<Vec3d>& points) {
  double length = 0.0;
  for (const Vec3d& point : points) {
    length += norm(point - from);
    from = point;
  }
  return length;
}

TEST(SurveyPlan, NoReversedSectionShortensTheWalk) {
  const RoomModel room = test::make_room();
  const std::vector<Vec3d> walk = plan_survey(room, {.points = 25}).points;
  for (auto first = walk.begin(); first != walk.end(); ++first) {
    for (auto last = first; last != walk.end(); ++last) {
      std::vector<Vec3d> other = walk;
      std::reverse(other.begin() + (first - walk.begin()),
                   other.begin() + (last - walk.begin()) + 1);
      EXPECT_GE(length_of(room.bounds_min, other), length_of(room.bounds_min, walk) - 1e-6);
    }
  }
}

}  // namespace
}  // namespace rayloc::survey_plan_test
