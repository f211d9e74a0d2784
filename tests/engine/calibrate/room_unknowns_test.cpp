#include "engine/calibrate/joint/room_unknowns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "engine/scene/scene.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::room_unknowns_test {
namespace {

// The plan of a room with three access points, and what may change of it.
struct Planned {
  RoomModel room = test::make_surveyed_room({.points = 0, .access_points = 3}).plan;
  RoomUnknowns unknowns{room, {}};

  std::size_t index(const std::string& name) const {
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      if (to_string(parameter_id(unknowns[i], room)) == name) {
        return i;
      }
    }
    ADD_FAILURE() << "no unknown " << name;
    return 0;
  }
  RoomModel changed(const std::string& name, double by) const {
    std::vector<double> values(unknowns.size());
    values[index(name)] = by;
    return changed_room(room, unknowns, values).value();
  }
};

Vec3d lower_corner(const Scene& scene, std::uint32_t object) {
  Vec3d lower = scene.objects()[object].mesh.vertices.front();
  for (const Vec3d& v : scene.objects()[object].mesh.vertices) {
    lower = {std::min(lower.x, v.x), std::min(lower.y, v.y), std::min(lower.z, v.z)};
  }
  return lower;
}

Vec3d upper_corner(const Scene& scene, std::uint32_t object) {
  Vec3d upper = scene.objects()[object].mesh.vertices.front();
  for (const Vec3d& v : scene.objects()[object].mesh.vertices) {
    upper = {std::max(upper.x, v.x), std::max(upper.y, v.y), std::max(upper.z, v.z)};
  }
  return upper;
}

TEST(RoomUnknowns, NoChangeIsTheSameRoom) {
  const Planned planned;
  const RoomModel same =
      changed_room(planned.room, planned.unknowns, std::vector<double>(planned.unknowns.size()))
          .value();
  const Scene& scene = *planned.room.scene;
  for (std::size_t i = 0; i < scene.objects().size(); ++i) {
    EXPECT_EQ(same.scene->objects()[i].mesh.vertices, scene.objects()[i].mesh.vertices);
  }
  for (std::size_t i = 0; i < scene.materials().size(); ++i) {
    EXPECT_EQ(same.scene->materials()[i].relative_permittivity,
              scene.materials()[i].relative_permittivity);
  }
  EXPECT_EQ(same.access_points[1].gains.gain, planned.room.access_points[1].gains.gain);
  ASSERT_EQ(same.surface_correction.size(), scene.surfaces().size());
  for (const std::complex<double>& correction : same.surface_correction) {
    EXPECT_EQ(correction, 1.0);
  }
}

// The inner face of the west wall looks along +x; the wall's other faces stay.
TEST(RoomUnknowns, AnOffsetMovesOneFaceAlongItsNormal) {
  const Planned planned;
  const RoomModel moved = planned.changed("west.+x.offset", 0.013);
  const Vec3d lower = lower_corner(*planned.room.scene, 0);
  const Vec3d upper = upper_corner(*planned.room.scene, 0);
  EXPECT_NEAR(upper_corner(*moved.scene, 0).x, upper.x + 0.013, 1e-12);
  EXPECT_NEAR(upper_corner(*moved.scene, 0).y, upper.y, 1e-12);
  EXPECT_NEAR(lower_corner(*moved.scene, 0).x, lower.x, 1e-12);
  EXPECT_NEAR(lower_corner(*moved.scene, 0).z, lower.z, 1e-12);
  for (std::uint32_t object = 1; object < moved.scene->objects().size(); ++object) {
    EXPECT_EQ(moved.scene->objects()[object].mesh.vertices,
              planned.room.scene->objects()[object].mesh.vertices);
  }
}

TEST(RoomUnknowns, MovesAndRotatesOneAccessPoint) {
  const Planned planned;
  const Pose& before = planned.room.access_points[1].array.pose;
  const Pose after = planned.changed("b.position.y", 0.004).access_points[1].array.pose;
  EXPECT_DOUBLE_EQ(after.position.y, before.position.y + 0.004);
  EXPECT_DOUBLE_EQ(after.position.x, before.position.x);
  EXPECT_DOUBLE_EQ(planned.changed("b.yaw", 0.02).access_points[1].array.pose.orientation.yaw,
                   before.orientation.yaw + 0.02);
  EXPECT_DOUBLE_EQ(planned.changed("b.pitch", 0.02).access_points[1].array.pose.orientation.pitch,
                   before.orientation.pitch + 0.02);
  EXPECT_DOUBLE_EQ(planned.changed("b.roll", 0.02).access_points[1].array.pose.orientation.roll,
                   before.orientation.roll + 0.02);
  EXPECT_DOUBLE_EQ(planned.changed("b.yaw", 0.02).access_points[0].array.pose.orientation.yaw,
                   planned.room.access_points[0].array.pose.orientation.yaw);
}

// The third element is read by core 3.
TEST(RoomUnknowns, MovesOneElementAlongTheArray) {
  const Planned planned;
  const auto& before = planned.room.access_points[2].array.element_offset;
  const auto after =
      planned.changed("c.core3.element_y", -0.001).access_points[2].array.element_offset;
  EXPECT_DOUBLE_EQ(after[2].y, before[2].y - 0.001);
  EXPECT_EQ(after[0], before[0]);
  EXPECT_EQ(after[1], before[1]);
  EXPECT_DOUBLE_EQ(after[2].x, before[2].x);
}

TEST(RoomUnknowns, MultipliesMaterialsOfThatName) {
  const Planned planned;
  const RoomModel changed = planned.changed("concrete.relative_permittivity", std::log(1.5));
  const RoomModel thicker = planned.changed("concrete.thickness", std::log(0.5));
  const RoomModel lossier = planned.changed("concrete.conductivity", std::log(3.0));
  int found = 0;
  for (std::size_t i = 0; i < planned.room.scene->materials().size(); ++i) {
    const RadioMaterial& before = planned.room.scene->materials()[i];
    const bool concrete = before.name == "concrete";
    found += concrete ? 1 : 0;
    EXPECT_NEAR(changed.scene->materials()[i].relative_permittivity,
                before.relative_permittivity * (concrete ? 1.5 : 1.0),
                1e-12);
    EXPECT_NEAR(
        thicker.scene->materials()[i].thickness, before.thickness * (concrete ? 0.5 : 1.0), 1e-12);
    EXPECT_NEAR(lossier.scene->materials()[i].conductivity / before.conductivity,
                concrete ? 3.0 : 1.0,
                1e-12);
  }
  EXPECT_EQ(found, 1);
}

TEST(RoomUnknowns, KeepsPermittivitiesPhysical) {
  const Planned planned;
  const RoomModel changed = planned.changed("wood.relative_permittivity", std::log(0.1));
  for (const RadioMaterial& material : changed.scene->materials()) {
    EXPECT_GE(material.relative_permittivity, 1.0);
  }
}

TEST(RoomUnknowns, ScalesTheGainsOfOneChain) {
  const Planned planned;
  const std::size_t tones = planned.room.grid.size();
  const auto& before = planned.room.access_points[0].gains.gain;
  const auto rotated = planned.changed("a.core0/core2.phase", 0.3).access_points[0].gains.gain;
  const auto louder =
      planned.changed("a.core0/core2.gain", std::log(1.2)).access_points[0].gains.gain;
  EXPECT_EQ(rotated[0], before[0]);
  EXPECT_EQ(rotated[2 * tones], before[2 * tones]);
  EXPECT_NEAR(std::abs(rotated[tones] - before[tones] * std::polar(1.0, 0.3)), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(louder[tones] - before[tones] * 1.2), 0.0, 1e-12);
}

TEST(RoomUnknowns, AddsToTheKnownCouplingOfTwoAntennas) {
  Planned planned;
  EXPECT_TRUE(planned.room.access_points[0].gains.coupling.empty());
  const auto first = planned.changed("a.core2/core0.coupling.im", 0.1).access_points[0].gains;
  const std::vector<std::complex<double>> one{1, {0, 0.1}, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_EQ(first.coupling, one);
  planned.room.access_points[0].gains = first;
  const auto both = planned.changed("a.core0/core3.coupling.re", 0.2).access_points[0].gains;
  const std::vector<std::complex<double>> product{1, {0, 0.1}, {0, 0.02}, 0, 1, 0.2, 0, 0, 1};
  for (std::size_t i = 0; i < product.size(); ++i) {
    EXPECT_NEAR(std::abs(both.coupling[i] - product[i]), 0.0, 1e-15) << i;
  }
}

TEST(RoomUnknowns, CorrectsTheReflectionOfOneSurface) {
  const Planned planned;
  const auto surface = planned.unknowns[planned.index("ceiling.-z.phase")].index;
  const RoomModel rotated = planned.changed("ceiling.-z.phase", 0.2);
  const RoomModel louder = planned.changed("ceiling.-z.gain", -0.1);
  EXPECT_NEAR(std::abs(rotated.surface_correction[surface] - std::polar(1.0, 0.2)), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(louder.surface_correction[surface] - std::exp(-0.1)), 0.0, 1e-12);
  EXPECT_EQ(rotated.surface_correction[surface + 1], 1.0);
}

TEST(RoomUnknowns, HasWiderPriorsForFurnitureThanForTheShell) {
  const RoomModel room = test::make_surveyed_room({.points = 0}).plan;
  CalibrationPriors priors;
  priors.room_surface = 0.01;
  priors.furniture_surface = 0.04;
  const RoomUnknowns unknowns(room, priors);
  for (const char* name : {"west", "floor", "ceiling"}) {
    for (const Unknown& unknown : unknowns.all()) {
      if (unknown.kind == Unknown::Kind::kSurfaceOffset &&
          to_string(parameter_id(unknown, room)).starts_with(name)) {
        EXPECT_EQ(unknown.sigma, priors.room_surface) << to_string(parameter_id(unknown, room));
      }
    }
  }
  for (const char* name : {"table", "cabinet", "shelf"}) {
    for (const Unknown& unknown : unknowns.all()) {
      if (unknown.kind == Unknown::Kind::kSurfaceOffset &&
          to_string(parameter_id(unknown, room)).starts_with(name)) {
        EXPECT_EQ(unknown.sigma, priors.furniture_surface)
            << to_string(parameter_id(unknown, room));
      }
    }
  }
}

TEST(RoomUnknowns, AreAtTheirStatedIndices) {
  const Planned planned;
  const RoomUnknowns& unknowns = planned.unknowns;
  const auto name = [&](std::size_t i) {
    return to_string(parameter_id(unknowns[i], planned.room));
  };
  EXPECT_EQ(name(unknowns.array_position(1)), "b.position.x");
  EXPECT_EQ(name(unknowns.array_angle(2) + 1), "c.pitch");
  EXPECT_EQ(name(unknowns.element_position(0, 2)), "a.core3.element_y");
  EXPECT_EQ(name(unknowns.chain_gain(2, 1)), "c.core0/core2.gain");
  EXPECT_EQ(name(unknowns.chain_gain(0, 2) + 1), "a.core3/core2.phase");
  EXPECT_EQ(name(unknowns.coupling(0)), "a.core2/core0.coupling.re");
  EXPECT_EQ(name(unknowns.coupling(1) + 5), "b.core0/core2.coupling.im");
  EXPECT_EQ(name(unknowns.coupling(2) + 11), "c.core3/core0.coupling.im");
  EXPECT_EQ(unknowns[unknowns.surface_phase(3)].kind, Unknown::Kind::kSurfacePhase);
  EXPECT_EQ(unknowns[unknowns.surface_phase(3)].index, 3U);
  EXPECT_EQ(name(unknowns.permittivity(0) + 2),
            planned.room.scene->materials()[0].name + ".thickness");
}

}  // namespace
}  // namespace rayloc::room_unknowns_test
