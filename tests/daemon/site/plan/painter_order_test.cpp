#include "daemon/site/plan/painter_order.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/site/plan/projection.h"
#include "tests/support/scenes.h"

namespace rayloc::draw::painter_order_test {
namespace {

const Vec3d kViewer = isometric_projection().towards_viewer;

// Where the line of sight through `eye` meets the face, as a distance towards the viewer; nothing
// when it passes beside it, or by less than `margin` from an edge.
std::optional<double> seen_at(const Face& face, const Vec3d& eye, double margin) {
  const Vec3d normal = normalized(face.normal);
  const double along = dot(normal, kViewer);
  if (std::abs(along) < 1e-6) {
    return std::nullopt;
  }
  const double at = dot(normal, face.corners[0] - eye) / along;
  const Vec3d point = eye + at * kViewer;
  double turns = 0.0;
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    const Vec3d& a = face.corners[i];
    const Vec3d& b = face.corners[(i + 1) % face.corners.size()];
    const double inside = dot(normal, cross(b - a, point - a)) / norm(b - a);
    if (std::abs(inside) < margin || (turns != 0.0 && inside * turns < 0.0)) {
      return std::nullopt;
    }
    turns = inside;
  }
  return at;
}

// The visible object at that place: that of the face which is painted last.
std::optional<std::uint32_t> painted(const std::vector<Face>& order, const Vec3d& eye) {
  std::optional<std::uint32_t> object;
  for (const Face& face : order) {
    if (seen_at(face, eye, 0.0)) {
      object = face.object;
    }
  }
  return object;
}

// The nearest object at that place. `is_clear` becomes false where rounding could decide.
std::optional<std::uint32_t> nearest(const std::vector<Face>& faces,
                                     const Vec3d& eye,
                                     bool& is_clear) {
  std::optional<std::uint32_t> object;
  double best = -std::numeric_limits<double>::infinity();
  is_clear = true;
  for (const Face& face : faces) {
    const auto at = seen_at(face, eye, 0.0);
    is_clear = is_clear && at.has_value() == seen_at(face, eye, 1e-3).has_value();
    if (at && *at > best) {
      is_clear = is_clear && *at - best > 1e-3;
      best = *at;
      object = face.object;
    } else if (at && best - *at < 1e-3) {
      is_clear = false;
    }
  }
  return object;
}

Face triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, std::uint32_t object) {
  return {{a, b, c}, {true, true, true}, normalized(cross(b - a, c - a)), false, object};
}

void expect_right_everywhere(const std::vector<Face>& faces, std::mt19937& random) {
  const std::vector<Face> order = painter_order(faces, kViewer);
  std::uniform_real_distribution<double> coordinate(-1.2, 1.2);
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d eye{coordinate(random), coordinate(random), coordinate(random)};
    bool is_clear = true;
    const auto expected = nearest(faces, eye, is_clear);
    if (is_clear && expected) {
      EXPECT_EQ(painted(order, eye), expected);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(PainterOrder, NearestFaceIsPaintedLastAmongRandomTriangles) {
  std::mt19937 random(20240611);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  const auto point = [&] {
    return Vec3d{coordinate(random), coordinate(random), coordinate(random)};
  };
  for (int round = 0; round < 10; ++round) {
    std::vector<Face> faces;
    for (std::uint32_t i = 0; i < 40; ++i) {
      faces.push_back(triangle(point(), point(), point(), i));
    }
    expect_right_everywhere(faces, random);
  }
}

TEST(PainterOrder, ThreeFacesThatCoverOneAnotherInACircleAreSplit) {
  // Each leans over the next: no order of the whole faces is right.
  const Projection page = isometric_projection();
  const auto at = [&](double x, double y, double depth) {
    return x * page.right + y * page.up + depth * page.towards_viewer;
  };
  std::vector<Face> faces;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const double turn = 2.0 * std::acos(-1.0) / 3.0 * i;
    const auto rotated = [&](double x, double y, double depth) {
      return at(
          std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y, depth);
    };
    faces.push_back(
        triangle(rotated(-1.0, -0.5, 0.3), rotated(1.0, -0.5, -0.3), rotated(1.0, -0.2, -0.3), i));
  }
  std::mt19937 random(7);
  const std::vector<Face> order = painter_order(faces, kViewer);
  EXPECT_GT(order.size(), faces.size());
  expect_right_everywhere(faces, random);
}

TEST(PainterOrder, FacesOfARoomNeedNoSplit) {
  const auto scene = test::make_scene({{"floor", test::box_mesh({0, 0, -0.1}, {4, 3, 0})},
                                       {"wall", test::box_mesh({0, 3, 0}, {4, 3.1, 2.5})},
                                       {"cabinet", test::box_mesh({1, 1, 0}, {1.5, 1.4, 1})}},
                                      test::kConcrete);
  EXPECT_EQ(painter_order(scene_faces(*scene), kViewer).size(), 18U);
}

TEST(PainterOrder, ManyFacesAreSortedByDistance) {
  std::vector<Face> faces;
  for (std::uint32_t i = 0; i <= kMaxSplit; ++i) {
    const double depth = (i * 7919 % 10'007) * 1e-3;
    const Vec3d corner = depth * kViewer;
    faces.push_back(triangle(corner, corner + Vec3d{1, 0, 0}, corner + Vec3d{0, 1, 0}, i));
  }
  const std::vector<Face> order = painter_order(faces, kViewer);
  ASSERT_EQ(order.size(), faces.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    ASSERT_LE(dot(order[i - 1].corners[0], kViewer), dot(order[i].corners[0], kViewer) + 1e-9);
  }
}

}  // namespace
}  // namespace rayloc::draw::painter_order_test
