#include "daemon/lab/calibrate/report/report_figures.h"

#include <algorithm>
#include <memory>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/site/plan/palette.h"
#include "engine/scene/moved_surfaces.h"
#include "engine/scene/scene.h"
#include "tests/daemon/lab/calibrate/sample_report.h"

namespace rayloc::report_figures_test {
namespace {

using draw::Drawing;

bool has_line(const Drawing& drawing, const draw::Colour& colour) {
  return std::any_of(drawing.shapes.begin(), drawing.shapes.end(), [&](const draw::Shape& shape) {
    const auto* line = std::get_if<draw::Line>(&shape);
    return line != nullptr && line->pen.colour == colour;
  });
}

// The inner face of the west wall: x = -1.5 m.
std::size_t west_face(const Scene& scene) {
  for (std::size_t i = 0; i < scene.surfaces().size(); ++i) {
    const auto& plane = scene.surfaces()[i].plane();
    if (std::abs(std::abs(plane.normal.x) - 1.0) < 1e-9 &&
        std::abs(plane.offset * plane.normal.x + 1.5) < 1e-9) {
      return i;
    }
  }
  ADD_FAILURE() << "no such face";
  return 0;
}

TEST(SurfaceDisplacements, AreThoseThatMovedTheScene) {
  const auto report = test::sample_report();
  const Scene& scene = *report.before.scene;
  std::vector<double> offset(scene.surfaces().size());
  offset[west_face(scene)] = 0.004;
  const auto moved = move_surfaces(scene, offset);
  ASSERT_TRUE(moved);
  const auto found = surface_displacements(scene, *moved);
  ASSERT_EQ(found.size(), offset.size());
  for (std::size_t i = 0; i < offset.size(); ++i) {
    EXPECT_NEAR(found[i], offset[i], 1e-9) << i;
  }
}

TEST(SurfaceDisplacements, AreUnknownBetweenDifferentScenes) {
  const auto report = test::sample_report();
  const Scene& scene = *report.before.scene;
  auto objects = scene.objects();
  objects.pop_back();
  const auto other = Scene::create({objects, scene.materials(), scene.carrier_hz()});
  ASSERT_TRUE(other);
  EXPECT_TRUE(surface_displacements(scene, *other).empty());
}

TEST(DisplacementPlan, ColoursTheLargestDisplacements) {
  auto report = test::sample_report();
  EXPECT_FALSE(has_line(draw_displacements(report), draw::signed_colour(1.0)));
  std::vector<double> offset(report.before.scene->surfaces().size());
  offset[west_face(*report.before.scene)] = 0.004;
  auto moved = move_surfaces(*report.before.scene, offset);
  ASSERT_TRUE(moved);
  report.methods.front().calibration.room.scene = std::make_shared<const Scene>(*std::move(moved));
  const Drawing plan = draw_displacements(report);
  EXPECT_TRUE(has_line(plan, draw::signed_colour(1.0)));
  EXPECT_TRUE(has_line(plan, draw::signed_colour(0.0)));
  EXPECT_FALSE(has_line(plan, draw::signed_colour(-1.0)));
}

TEST(ResidualMap, RingsThePointsHeldOut) {
  const Drawing map = draw_residuals(test::sample_report(), 0);
  int ringed = 0;
  int dots = 0;
  for (const draw::Shape& shape : map.shapes) {
    const auto* circle = std::get_if<draw::Circle>(&shape);
    if (circle != nullptr && circle->fill != draw::kReceiverInk &&
        circle->fill != draw::Colour{255, 255, 255, 1.0}) {
      ++dots;
      ringed += circle->outline->colour == draw::kInk ? 1 : 0;
    }
  }
  EXPECT_EQ(dots, 4);
  EXPECT_EQ(ringed, 2);
}

TEST(FitDistribution, HasACurveForThePlanAndEachMethod) {
  const Drawing chart = draw_fit_distribution(test::sample_report(), 0);
  EXPECT_TRUE(has_line(chart, draw::kFaintInk));
  EXPECT_TRUE(has_line(chart, draw::curve_colour(0)));
  EXPECT_TRUE(has_line(chart, draw::curve_colour(1)));
}

}  // namespace
}  // namespace rayloc::report_figures_test
