// A room as a scanner measures it, beside meshes that have as many faces for good reasons.
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/site/scene/rough_mesh.h"
#include "daemon/site/scene/scene_report.h"
#include "tests/support/rotated_walls.h"
#include "tests/support/scenes.h"

namespace rayloc::rough_mesh_test {
namespace {

// nu x nv quads of two triangles.
Mesh patch(std::uint32_t nu, std::uint32_t nv, const std::function<Vec3d(double, double)>& place) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= nv; ++j) {
    for (std::uint32_t i = 0; i <= nu; ++i) {
      mesh.vertices.push_back(place(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
    }
  }
  for (std::uint32_t j = 0; j < nv; ++j) {
    for (std::uint32_t i = 0; i < nu; ++i) {
      const std::uint32_t a = j * (nu + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + nu + 2});
      mesh.triangles.push_back({a, a + nu + 2, a + nu + 1});
    }
  }
  return mesh;
}

void append(const Mesh& part, Mesh& all) {
  const auto first = static_cast<std::uint32_t>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles) {
    all.triangles.push_back({first + a, first + b, first + c});
  }
}

// As a scanner of `error` [m] measures a mesh.
Mesh scanned(Mesh mesh, double error) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, error);
  for (Vec3d& v : mesh.vertices) {
    v = v + Vec3d{noise(random), noise(random), noise(random)};
  }
  return mesh;
}

// As a scanner that smooths its points measures it: an error that is the same over some decimetres.
Mesh smoothly_scanned(Mesh mesh, double error) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  struct Wave {
    Vec3d number, shift;
    double phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 60; ++i) {
    const auto vector = [&](double length) {
      return Vec3d{length * share(random), length * share(random), length * share(random)};
    };
    waves.push_back({vector(25.0), vector(error / 3.0), 3.0 * share(random)});
  }
  for (Vec3d& v : mesh.vertices) {
    Vec3d off;
    for (const Wave& wave : waves) {
      off = off + std::sin(dot(wave.number, v) + wave.phase) * wave.shift;
    }
    v = v + off;
  }
  return mesh;
}

Mesh room(double size) {
  return test::subdivided(test::box_mesh({0, 0, 0}, {4 * size, 3 * size, 2.5 * size}), 20);
}

// Vertices at one place must stay at one place.
Mesh welded(const Mesh& mesh) {
  std::vector<Vec3d> vertices;
  Mesh result;
  for (const auto& t : mesh.triangles) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& v = mesh.vertices[t.at(k)];
      std::size_t i = 0;
      while (i < result.vertices.size() && norm(result.vertices[i] - v) > 1e-9) {
        ++i;
      }
      if (i == result.vertices.size()) {
        result.vertices.push_back(v);
      }
      corners.at(k) = static_cast<std::uint32_t>(i);
    }
    result.triangles.push_back(corners);
  }
  return result;
}

TEST(Field, RoomWithRoughWallsIsAScan) {
  for (const double error : {0.003, 0.01, 0.02}) {
    EXPECT_TRUE(is_rough_mesh(scanned(welded(room(1.0)), error))) << error;
  }
  for (const double error : {0.005, 0.015}) {
    EXPECT_TRUE(is_rough_mesh(smoothly_scanned(room(1.0), error))) << error;
  }
  // One wall of a scan that is exported wall by wall.
  const Mesh wall = patch(40, 25, [](double u, double v) { return Vec3d{4 * u, 0, 2.5 * v}; });
  EXPECT_TRUE(is_rough_mesh(scanned(wall, 0.01)));
}

TEST(Field, MeshesOfManyHonestFacesAreNoScan) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  EXPECT_FALSE(is_rough_mesh(room(1.0)));
  // A small thing may be as rough as it likes.
  EXPECT_FALSE(is_rough_mesh(scanned(welded(room(0.2)), 0.002)));
  for (const std::uint32_t n : {16U, 40U, 80U}) {
    EXPECT_FALSE(is_rough_mesh(patch(2 * n,
                                     n,
                                     [&](double u, double v) {
                                       const double polar = 0.05 + (std::numbers::pi - 0.1) * v;
                                       return Vec3d{3 * std::sin(polar) * std::cos(kTurn * u),
                                                    3 * std::sin(polar) * std::sin(kTurn * u),
                                                    3 * std::cos(polar)};
                                     })))
        << "sphere of " << n;
    EXPECT_FALSE(is_rough_mesh(patch(2 * n,
                                     n,
                                     [&](double u, double v) {
                                       const double radius = 2 + 0.8 * std::cos(kTurn * v);
                                       return Vec3d{radius * std::cos(kTurn * u),
                                                    radius * std::sin(kTurn * u),
                                                    0.8 * std::sin(kTurn * v)};
                                     })))
        << "torus of " << n;
    EXPECT_FALSE(is_rough_mesh(
        patch(2 * n,
              n,
              [&](double u, double v) {
                return Vec3d{4 * u, 0.3 * std::sin(2 * kTurn * u) * std::cos(kTurn * v), 2.5 * v};
              })))
        << "wave of " << n;
  }
  // A hundred pieces of furniture in one mesh: boxes, and legs of eight sides.
  Mesh furniture;
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 10; ++j) {
      const Vec3d at{0.4 * i, 0.3 * j, 0.0};
      append(test::box_mesh(at, at + Vec3d{0.2, 0.2, 0.1}), furniture);
      append(patch(8,
                   3,
                   [&](double u, double v) {
                     return at + Vec3d{0.1 + 0.02 * std::cos(kTurn * u),
                                       0.1 + 0.02 * std::sin(kTurn * u),
                                       0.1 + 0.4 * v};
                   }),
             furniture);
    }
  }
  EXPECT_FALSE(is_rough_mesh(furniture));
}

TEST(Field, CheckOfAScanNamesTheScanAndNoMissingFace) {
  const auto report_of = [](Mesh mesh) {
    return inspect_scene(
        {"test", "", test::make_scene({{"room", std::move(mesh)}}, test::kConcrete), std::nullopt});
  };
  Mesh open = scanned(welded(room(1.0)), 0.01);
  open.triangles.pop_back();
  const SceneReport report = report_of(open);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_EQ(report.warnings[0].kind, "rough_scan");
  for (const char* word : {"'room'", "rough", "simplify", "scene import"}) {
    EXPECT_NE(report.warnings[0].message.find(word), std::string::npos) << word;
  }
  EXPECT_TRUE(report_of(welded(room(1.0))).warnings.empty());
}

}  // namespace
}  // namespace rayloc::rough_mesh_test
