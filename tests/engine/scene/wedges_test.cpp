#include "engine/scene/wedges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/mat3.h"
#include "engine/scene/bounds.h"
#include "engine/scene/solid.h"
#include "tests/support/laboratory.h"
#include "tests/support/scenes.h"

namespace rayloc::wedges_test {
namespace {

using test::box_mesh;
using test::rectangle_mesh;

std::vector<Wedge> wedges_of(const std::vector<Mesh>& meshes) {
  std::vector<test::NamedMesh> named;
  named.reserve(meshes.size());
  for (const Mesh& mesh : meshes) {
    named.push_back({"object " + std::to_string(named.size()), mesh});
  }
  return find_wedges(*test::make_scene(named, test::kConcrete));
}

double total_length(const std::vector<Wedge>& wedges) {
  double sum = 0.0;
  for (const Wedge& wedge : wedges) {
    sum += norm(wedge.to - wedge.from);
  }
  return sum;
}

Vec3d beside(const Wedge& wedge, double azimuth, double distance) {
  return 0.5 * (wedge.from + wedge.to) + (distance * std::cos(azimuth)) * wedge.in_face +
         (distance * std::sin(azimuth)) * wedge.normal;
}

Mesh rotated(Mesh mesh, bool as_float) {
  const Mat3d turn = rotation_from_yaw_pitch_roll(0.4, 0.2, -0.7);
  for (Vec3d& v : mesh.vertices) {
    v = turn * v + Vec3d{12.0, -7.0, 3.0};
    if (as_float) {
      v = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    }
  }
  return mesh;
}

TEST(Wedges, BoxHasTwelveRightAngles) {
  const Mesh box = box_mesh({0, 0, 0}, {1, 2, 3});
  for (const Mesh& mesh : {box, rotated(box, false), rotated(box, true)}) {
    const std::vector<Wedge> wedges = wedges_of({mesh});
    ASSERT_EQ(wedges.size(), 12U);
    EXPECT_NEAR(total_length(wedges), 24.0, 1e-4);
    for (const Wedge& wedge : wedges) {
      EXPECT_NEAR(wedge.n, 1.5, 1e-5);
      EXPECT_FALSE(wedge.is_free());
      EXPECT_NEAR(norm(wedge.normal), 1.0, 1e-12);
      // The sector is outside, the rest inside.
      for (const double share : {0.01, 0.5, 0.99}) {
        EXPECT_FALSE(is_inside(mesh, beside(wedge, share * wedge.n * std::numbers::pi, 0.1)));
      }
      EXPECT_TRUE(is_inside(mesh, beside(wedge, 1.75 * std::numbers::pi, 0.1)));
    }
  }
}

TEST(Wedges, ReversedFacesChangeNothing) {
  Mesh mesh = box_mesh({0, 0, 0}, {1, 2, 3});
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  }
  EXPECT_EQ(wedges_of({mesh}).size(), 12U);
}

TEST(Wedges, SheetHasFreeEdges) {
  const std::vector<Wedge> wedges = wedges_of({rectangle_mesh({0, 0, 0}, {2, 0, 0}, {0, 0, 1})});
  ASSERT_EQ(wedges.size(), 4U);
  for (const Wedge& wedge : wedges) {
    EXPECT_DOUBLE_EQ(wedge.n, 2.0);
    EXPECT_TRUE(wedge.is_free());
  }
  EXPECT_DOUBLE_EQ(total_length(wedges), 6.0);
}

TEST(Wedges, SheetsThatMeetShareAnEdge) {
  for (const double angle : {20.0, 90.0, 130.0, 178.0}) {
    const double radians = angle * std::numbers::pi / 180.0;
    const std::vector<Wedge> wedges = wedges_of(
        {rectangle_mesh({0, 0, 0}, {1, 0, 0}, {0, 0, 2}),
         rectangle_mesh({0, 0, 0}, {std::cos(radians), std::sin(radians), 0}, {0, 0, 2})});
    ASSERT_EQ(wedges.size(), 7U) << angle;
    const auto shared = std::find_if(
        wedges.begin(), wedges.end(), [](const Wedge& wedge) { return !wedge.is_free(); });
    ASSERT_NE(shared, wedges.end());
    EXPECT_NEAR(shared->n, 2.0 - angle / 180.0, 1e-12);
    EXPECT_DOUBLE_EQ(norm(shared->to - shared->from), 2.0);
  }
}

TEST(Wedges, CoplanarNeighboursHaveNone) {
  // One object each, and side by side: the seam is none.
  const std::vector<Wedge> wedges = wedges_of({rectangle_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                               rectangle_mesh({1, 0, 0}, {1, 0, 0}, {0, 1, 0})});
  EXPECT_EQ(wedges.size(), 6U);
  EXPECT_NEAR(total_length(wedges), 6.0, 1e-12);
}

TEST(Wedges, HoleHasEdgesToo) {
  // Four rectangles about a hole of one square metre, whose corners lie on sides of others.
  Mesh frame;
  for (const Mesh& part : {rectangle_mesh({0, 0, 0}, {2, 0, 0}, {0, 1, 0}),
                           rectangle_mesh({2, 0, 0}, {1, 0, 0}, {0, 2, 0}),
                           rectangle_mesh({1, 2, 0}, {2, 0, 0}, {0, 1, 0}),
                           rectangle_mesh({0, 1, 0}, {1, 0, 0}, {0, 2, 0})}) {
    const auto first = static_cast<std::uint32_t>(frame.vertices.size());
    frame.vertices.insert(frame.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles) {
      frame.triangles.push_back({first + a, first + b, first + c});
    }
  }
  const std::vector<Wedge> wedges = wedges_of({frame});
  EXPECT_NEAR(total_length(wedges), 12.0 + 4.0, 1e-4);
  EXPECT_TRUE(std::all_of(
      wedges.begin(), wedges.end(), [](const Wedge& wedge) { return wedge.is_free(); }));
}

TEST(Wedges, AreAbsentWhereABoxMeetsTheFloor) {
  // Half of the box is over the edge of the floor.
  const std::vector<Wedge> wedges =
      wedges_of({rectangle_mesh({0, 0, 0}, {4, 0, 0}, {0, 4, 0}), box_mesh({3, 1, 0}, {5, 2, 1})});
  double at_the_foot = 0.0;
  for (const Wedge& wedge : wedges) {
    const bool low = wedge.from.z == 0.0 && wedge.to.z == 0.0;
    at_the_foot += low && !wedge.is_free() ? norm(wedge.to - wedge.from) : 0.0;
  }
  // That which hangs over: its end of 1 m and two sides of 1 m. Where the floor ends under the box
  // nothing is open.
  EXPECT_NEAR(at_the_foot, 3.0, 1e-4);
  EXPECT_NEAR(total_length(wedges), (16.0 - 1.0) + 3.0 + 6.0 + 4.0, 1e-4);
}

TEST(Wedges, FlushBodiesAreOne) {
  const std::vector<Wedge> wedges =
      wedges_of({box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({1, 0, 0}, {2, 1, 1})});
  EXPECT_NEAR(total_length(wedges), 4 * 2.0 + 8 * 1.0, 1e-4);
}

// By which of the four quarters about an edge are filled: another way to the same lengths.
class Quarters {
 public:
  explicit Quarters(const Scene& scene) {
    for (const SceneObject& object : scene.objects()) {
      boxes_.push_back(bounds_of(object.mesh));
    }
  }

  // Where one of the four is filled, over the edges of all boxes.
  double length() const {
    double sum = 0.0;
    for (std::size_t box = 0; box < boxes_.size(); ++box) {
      for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t corner = 0; corner < 4; ++corner) {
          sum += length_of(box, axis, corner);
        }
      }
    }
    return sum;
  }

 private:
  static double part(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
  static Vec3d from_parts(int axis, double along, double b, double c) {
    return axis == 0 ? Vec3d{along, b, c} : axis == 1 ? Vec3d{c, along, b} : Vec3d{b, c, along};
  }
  bool filled(const Vec3d& p) const {
    return std::any_of(
        boxes_.begin(), boxes_.end(), [&](const auto& box) { return box.contains(p); });
  }

  double length_of(std::size_t box, int axis, std::size_t corner) const {
    constexpr int kSteps = 4000;
    constexpr double kOff = 1e-3;  // [m]
    const int b_axis = (axis + 1) % 3;
    const int c_axis = (axis + 2) % 3;
    const double b = part(corner % 2 == 0 ? boxes_[box].lower : boxes_[box].upper, b_axis);
    const double c = part(corner / 2 == 0 ? boxes_[box].lower : boxes_[box].upper, c_axis);
    const double begin = part(boxes_[box].lower, axis);
    const double step = (part(boxes_[box].upper, axis) - begin) / kSteps;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double along = begin + (i + 0.5) * step;
      int count = 0;
      for (const double db : {-kOff, kOff}) {
        for (const double dc : {-kOff, kOff}) {
          count += filled(from_parts(axis, along, b + db, c + dc)) ? 1 : 0;
        }
      }
      sum += count == 1 ? step : 0.0;
    }
    return sum;
  }

  std::vector<Bounds> boxes_;
};

TEST(Wedges, LaboratoryHasThoseOfItsFilledQuarters) {
  const auto scene = test::laboratory();
  const std::vector<Wedge> wedges = find_wedges(*scene);
  for (const Wedge& wedge : wedges) {
    EXPECT_NEAR(wedge.n, 1.5, 1e-9);
  }
  EXPECT_NEAR(total_length(wedges), Quarters(*scene).length(), 0.02);
}

}  // namespace
}  // namespace rayloc::wedges_test
