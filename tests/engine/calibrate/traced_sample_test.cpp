// The first-order prediction of a ray against the room traced anew.
#include "engine/calibrate/joint/traced_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "engine/base/constants.h"
#include "engine/scene/scene.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::traced_sample_test {
namespace {

using Kind = Unknown::Kind;

const Vec3d kPlace{0.7, 0.3, 1.25};
constexpr TraceOptions kTrace{.max_depth = 2};

TracedSample traced(const RoomModel& room, const RoomUnknowns& unknowns, const Vec3d& place) {
  const std::vector<SampleSite> sites{{4, 0, place}};
  return trace_samples(room, unknowns, sites, kTrace).value().front();
}

RayTerm term_of(const TracedSample& sample, const LinearRay& ray, std::uint32_t unknown) {
  for (const RayTerm& term : sample.terms_of(ray)) {
    if (term.unknown == unknown) {
      return term;
    }
  }
  return {unknown, 0.0, 0.0};
}

// A room that is neither as planned nor symmetric.
struct Link {
  RoomModel plan;
  RoomUnknowns unknowns;
  std::vector<double> values;  // where it is traced

  Link()
      : plan(tilted(test::make_surveyed_room({.points = 0}).plan)),
        unknowns(plan, {}),
        values(unknowns.size()) {
    values[unknowns.surface_offset(0)] = 0.004;
    values[unknowns.array_position(0)] = 0.003;
    values[unknowns.array_angle(0)] = 0.02;
    values[unknowns.permittivity(0)] = 0.1;
  }

  static RoomModel tilted(RoomModel room) {
    room.access_points[0].array.pose.orientation.pitch = 0.1;
    room.access_points[0].array.pose.orientation.roll = -0.2;
    return room;
  }

  TracedSample at(std::uint32_t unknown, double by) const {
    std::vector<double> changed = values;
    changed[unknown] += by;
    return traced(changed_room(plan, unknowns, changed).value(), unknowns, kPlace);
  }
  TracedSample here() const { return at(0, 0.0); }
};

// Step of central differences of rooms traced anew: it leaves the paths the same ones.
constexpr double kStep = 1e-5;

struct Worst {
  double delay = 0.0;          // [s per unit]
  double log_amplitude = 0.0;  // per unit
  int rays = 0;                // that depend on the unknown
};

Worst worst_difference(const Link& link, std::uint32_t unknown, const TracedSample& here) {
  const TracedSample above = link.at(unknown, kStep);
  const TracedSample below = link.at(unknown, -kStep);
  Worst worst;
  for (std::size_t e = 0; e < here.rays.size(); ++e) {
    EXPECT_EQ(above.rays[e].size(), here.rays[e].size());
    EXPECT_EQ(below.rays[e].size(), here.rays[e].size());
    for (std::size_t r = 0; r < here.rays[e].size(); ++r) {
      const RayTerm term = term_of(here, here.rays[e][r], unknown);
      const double delay = (above.rays[e][r].delay - below.rays[e][r].delay) / (2.0 * kStep);
      const auto log_amplitude =
          std::log(above.rays[e][r].amplitude / below.rays[e][r].amplitude) / (2.0 * kStep);
      worst.delay = std::max(worst.delay, std::abs(delay - term.delay));
      if (link.unknowns[unknown].kind == Kind::kPermittivity ||
          link.unknowns[unknown].kind == Kind::kConductivity ||
          link.unknowns[unknown].kind == Kind::kThickness) {
        worst.log_amplitude =
            std::max(worst.log_amplitude, std::abs(log_amplitude - term.log_amplitude));
      }
      worst.rays += term.delay != 0.0 || term.log_amplitude != 0.0 ? 1 : 0;
    }
  }
  return worst;
}

// For every kind of unknown: surfaces, the array, its elements, materials.
TEST(TracedSample, FollowsTheRoomTracedAnew) {
  const Link link;
  const TracedSample here = link.here();
  int depending = 0;
  for (std::uint32_t unknown = 0; unknown < link.unknowns.size(); ++unknown) {
    const Kind kind = link.unknowns[unknown].kind;
    if (kind == Kind::kSurfaceGain || kind == Kind::kSurfacePhase || kind == Kind::kChainGain ||
        kind == Kind::kChainPhase) {
      continue;  // in no scene
    }
    const Worst worst = worst_difference(link, unknown, here);
    const std::string name = to_string(parameter_id(link.unknowns[unknown], link.plan));
    // 1e-6 of a metre per metre, and rounding of delays of 40 ns by a step of 1e-5.
    EXPECT_LT(worst.delay * kSpeedOfLight, 1e-6) << name;
    EXPECT_LT(worst.log_amplitude, 1e-5) << name;
    depending += worst.rays > 0 ? 1 : 0;
  }
  // The six faces that look into the room, the array, its elements, four materials: no test of
  // zeros alone.
  EXPECT_GT(depending, 20);
}

TEST(TracedSample, FollowsTheDeviceTracedAnew) {
  const Link link;
  const RoomModel room = changed_room(link.plan, link.unknowns, link.values).value();
  const TracedSample here = link.here();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3d step{axis == 0 ? kStep : 0.0, axis == 1 ? kStep : 0.0, axis == 2 ? kStep : 0.0};
    const TracedSample above = traced(room, link.unknowns, kPlace + step);
    const TracedSample below = traced(room, link.unknowns, kPlace - step);
    for (std::size_t e = 0; e < here.rays.size(); ++e) {
      ASSERT_EQ(above.rays[e].size(), here.rays[e].size());
      for (std::size_t r = 0; r < here.rays[e].size(); ++r) {
        const double slope = (above.rays[e][r].delay - below.rays[e][r].delay) / (2.0 * kStep);
        EXPECT_NEAR(slope * kSpeedOfLight, here.rays[e][r].survey.at(axis) * kSpeedOfLight, 1e-6);
      }
    }
  }
}

// The error of the first order is of the size of the offset's square over the path's length.
TEST(TracedSample, IsLinearOverAWallsCentimetre) {
  constexpr double kOffset = 0.01;  // [m]
  const Link link;
  const TracedSample here = link.here();
  int compared = 0;
  double missed = 0.0;
  for (std::uint32_t unknown = 0; unknown < link.plan.scene->surfaces().size(); ++unknown) {
    const TracedSample there = link.at(unknown, kOffset);
    for (std::size_t e = 0; e < here.rays.size(); ++e) {
      if (there.rays[e].size() != here.rays[e].size()) {
        continue;  // a path came or went at an edge
      }
      for (std::size_t r = 0; r < here.rays[e].size(); ++r) {
        const double slope = term_of(here, here.rays[e][r], unknown).delay;
        const double predicted = here.rays[e][r].delay + kOffset * slope;
        missed = std::max(missed, kSpeedOfLight * std::abs(there.rays[e][r].delay - predicted));
        compared += slope != 0.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(compared, 50);
  EXPECT_LT(missed, 1e-4);
}

TEST(TracedSample, CountsEveryReflectionOnASurface) {
  const Link link;
  const TracedSample here = link.here();
  double most = 0.0;
  for (const auto& rays : here.rays) {
    double direct = 1.0;
    for (const LinearRay& ray : rays) {
      double reflections = 0.0;
      for (std::uint32_t s = 0; s < link.plan.scene->surfaces().size(); ++s) {
        const RayTerm gain = term_of(here, ray, link.unknowns.surface_gain(s));
        const RayTerm phase = term_of(here, ray, link.unknowns.surface_phase(s));
        EXPECT_EQ(phase.log_amplitude, gain.log_amplitude * std::complex<double>(0.0, 1.0));
        reflections += gain.log_amplitude.real();
      }
      direct = std::min(direct, reflections);
      most = std::max(most, reflections);
    }
    EXPECT_EQ(direct, 0.0);  // the line of sight meets none
  }
  EXPECT_EQ(most, 2.0);
}

TEST(TracedSample, HasNoGainParameterForTheFirstChain) {
  const Link link;
  const TracedSample here = link.here();
  for (std::size_t e = 0; e < here.rays.size(); ++e) {
    for (std::size_t other = 1; other < here.rays.size(); ++other) {
      const std::uint32_t gain = link.unknowns.chain_gain(0, other);
      for (const LinearRay& ray : here.rays[e]) {
        EXPECT_EQ(term_of(here, ray, gain).log_amplitude, e == other ? 1.0 : 0.0);
        EXPECT_EQ(term_of(here, ray, gain + 1).log_amplitude,
                  std::complex<double>(0.0, e == other ? 1.0 : 0.0));
      }
    }
  }
}

TEST(TracedSample, HasItsPointAndAccessPoint) {
  const TracedSample here = Link().here();
  EXPECT_EQ(here.point, 4U);
  EXPECT_EQ(here.access_point, 0U);
  EXPECT_EQ(here.rays.size(), 3U);
}

}  // namespace
}  // namespace rayloc::traced_sample_test
