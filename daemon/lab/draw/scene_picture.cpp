#include "daemon/lab/draw/scene_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "daemon/lab/draw/labels.h"
#include "daemon/lab/draw/legend.h"
#include "daemon/lab/draw/views.h"
#include "daemon/site/plan/palette.h"
#include "daemon/site/plan/projection.h"
#include "engine/base/check.h"

namespace rayloc::draw {
namespace {

constexpr double kSceneMargin = 20.0;
constexpr double kSceneRulerMargin = 48.0;  // left of and below a plan: numbers and names of walls
constexpr double kSceneTitleHeight = 56.0;
constexpr double kSceneMaxWidth = 1'100.0;  // size of the room on the page
constexpr double kSceneMaxHeight = 760.0;
constexpr double kSceneMaxPixelsPerMetre = 200.0;

// The extent of the scene on the page at one pixel per metre.
struct Extent {
  PagePoint lower{1e300, 1e300};
  PagePoint upper{-1e300, -1e300};

  void include(const PagePoint& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
};

Extent extent_of(const Bounds& bounds, const Projection& projection) {
  Extent extent;
  for (unsigned i = 0; i < 8; ++i) {
    extent.include(projection({(i & 1U) != 0 ? bounds.upper.x : bounds.lower.x,
                               (i & 2U) != 0 ? bounds.upper.y : bounds.lower.y,
                               (i & 4U) != 0 ? bounds.upper.z : bounds.lower.z}));
  }
  return extent;
}

// Bounds of everything drawn: the scene, and antennas and zones that may be outside of it.
Bounds bounds_of(const ScenePicture& picture) {
  Bounds bounds{picture.scene->bounds_min(), picture.scene->bounds_max()};
  for (const Mark& mark : picture.marks) {
    for (const Vec3d& antenna : mark.antennas) {
      bounds.include(antenna);
    }
  }
  for (const DrawnZone& zone : picture.zones) {
    for (const auto& [x, y] : zone.polygon) {
      bounds.include({x, y, picture.scene->bounds_min().z});
    }
  }
  return bounds;
}

struct Page {
  Projection projection;
  double width = 0.0;  // width of the room on it
  double height = 0.0;
};

Page fit(const Bounds& bounds, View view) {
  Page page;
  page.projection = view == View::kPlan ? plan_projection() : isometric_projection();
  const Extent extent = extent_of(bounds, page.projection);
  const double across = std::max(extent.upper.x - extent.lower.x, 1e-3);
  const double down = std::max(extent.upper.y - extent.lower.y, 1e-3);
  const double scale =
      std::min({kSceneMaxWidth / across, kSceneMaxHeight / down, kSceneMaxPixelsPerMetre});
  page.projection.scale = scale;
  page.projection.origin = {kSceneMargin + kSceneRulerMargin - scale * extent.lower.x,
                            kSceneTitleHeight + kSceneMargin - scale * extent.lower.y};
  page.width = scale * across;
  page.height = scale * down;
  return page;
}

void draw_paths(const ScenePicture& picture, const Projection& page, std::vector<Shape>& shapes) {
  std::vector<const DrawnPath*> weakest_first;
  for (const DrawnPath& path : picture.paths) {
    weakest_first.push_back(&path);
  }
  std::stable_sort(weakest_first.begin(), weakest_first.end(), [](const auto* a, const auto* b) {
    return a->power_db < b->power_db;
  });
  const double range = std::max(picture.strongest_db - picture.weakest_db, 1e-9);
  for (const DrawnPath* path : weakest_first) {
    const double share = std::clamp((path->power_db - picture.weakest_db) / range, 0.0, 1.0);
    const Colour colour = power_colour(share);
    std::vector<PagePoint> points;
    for (const Vec3d& point : path->points) {
      points.push_back(page(point));
    }
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      shapes.emplace_back(Circle{points[i], 1.3 + share, colour, std::nullopt});
    }
    shapes.emplace_back(Line{std::move(points), {colour, 0.7 + 1.6 * share}});
  }
}

void draw_heading(const Mark& mark, const Projection& page, std::vector<Shape>& shapes) {
  constexpr double kArrow = 26.0;  // pixels
  const Vec3d from = (1.0 / static_cast<double>(mark.antennas.size())) * [&] {
    Vec3d sum;
    for (const Vec3d& antenna : mark.antennas) {
      sum = sum + antenna;
    }
    return sum;
  }();
  const PagePoint tail = page(from);
  const PagePoint tip = page(from + (kArrow / page.scale) * mark.heading);
  const double dx = tip.x - tail.x;
  const double dy = tip.y - tail.y;
  if (std::hypot(dx, dy) < 4.0) {
    return;  // it points to the viewer
  }
  shapes.emplace_back(Line{{tail, tip}, {kReceiverInk, 1.2}});
  shapes.emplace_back(Polygon{{tip,
                               {tip.x - 0.25 * dx - 0.14 * dy, tip.y - 0.25 * dy + 0.14 * dx},
                               {tip.x - 0.25 * dx + 0.14 * dy, tip.y - 0.25 * dy - 0.14 * dx}},
                              kReceiverInk});
}

void draw_marks(const ScenePicture& picture,
                View view,
                const Projection& page,
                Labels& labels,
                std::vector<Shape>& shapes) {
  const double floor = picture.scene->bounds_min().z;
  for (const Mark& mark : picture.marks) {
    if (mark.kind == MarkKind::kAccessPoint) {
      draw_heading(mark, page, shapes);
    } else if (view == View::k3d) {  // its height: a line down to the floor
      Vec3d below = mark.antennas.front();
      below.z = floor;
      shapes.emplace_back(Line{{page(mark.antennas.front()), page(below)}, {kFaintInk, 0.8, true}});
    }
    for (const Vec3d& antenna : mark.antennas) {
      append_shapes(draw_antenna(page(antenna), mark.kind), shapes);
    }
    Extent extent;
    for (const Vec3d& antenna : mark.antennas) {
      extent.include(page(antenna));
    }
    std::vector<Text> places;  // above or below, first on the side without the arrow
    for (const double y : {extent.lower.y - 9.0, extent.upper.y + 17.0}) {
      Text text{{0.5 * (extent.lower.x + extent.upper.x), y},
                mark.name,
                11.0,
                mark.kind == MarkKind::kTransmitter ? kTransmitterInk : kReceiverInk,
                TextAnchor::kMiddle};
      text.bold = true;
      text.halo = true;
      places.push_back(std::move(text));
    }
    if (dot(page.up, mark.heading) > 0.0) {
      std::reverse(places.begin(), places.end());
    }
    labels.place(places);
  }
}

// A tint over the floor, a dashed outline, and the name at the centroid of its corners.
void draw_zones(const ScenePicture& picture,
                const Projection& page,
                Labels& labels,
                std::vector<Shape>& shapes) {
  for (const DrawnZone& zone : picture.zones) {
    std::vector<PagePoint> corners;
    PagePoint middle{0.0, 0.0};
    for (const auto& [x, y] : zone.polygon) {
      corners.push_back(page({x, y, picture.scene->bounds_min().z}));
      middle.x += corners.back().x / static_cast<double>(zone.polygon.size());
      middle.y += corners.back().y / static_cast<double>(zone.polygon.size());
    }
    shapes.emplace_back(Polygon{corners, kZoneTint});
    corners.push_back(corners.front());
    shapes.emplace_back(Line{std::move(corners), {kZoneInk, 1.2, true}});
    Text name{middle, zone.name, 11.0, kZoneInk, TextAnchor::kMiddle};
    name.halo = true;
    labels.place({name});
  }
}

void draw_title(const ScenePicture& picture, std::vector<Shape>& shapes) {
  Text title{{kSceneMargin, kSceneMargin + 10.0}, picture.title, 15.0, kInk};
  title.bold = true;
  shapes.emplace_back(std::move(title));
  shapes.emplace_back(Text{{kSceneMargin, kSceneMargin + 28.0}, picture.caption, 10.5, kFaintInk});
}

}  // namespace

Drawing draw_scene(const ScenePicture& picture, View view) {
  RAYLOC_CHECK(picture.scene != nullptr);
  const Scene& scene = *picture.scene;
  const std::vector<ScenePart> parts = scene_parts(scene);
  const Bounds all{scene.bounds_min(), scene.bounds_max()};
  const Page page = fit(bounds_of(picture), view);
  Drawing drawing;
  Labels labels;
  draw_title(picture, drawing.shapes);
  if (view == View::kPlan) {
    append_shapes(draw_plan(scene, parts, page.projection), drawing.shapes);
    append_shapes(draw_ruler(all, page.projection, labels), drawing.shapes);
  } else {
    append_shapes(draw_isometric(scene, parts, page.projection), drawing.shapes);
    append_shapes(
        draw_axes({kSceneMargin + 32.0, kSceneTitleHeight + kSceneMargin + page.height - 8.0}),
        drawing.shapes);
  }
  draw_zones(picture, page.projection, labels, drawing.shapes);
  draw_paths(picture, page.projection, drawing.shapes);
  draw_marks(picture, view, page.projection, labels, drawing.shapes);
  if (view == View::kPlan) {
    label_plan(parts, all, page.projection, labels);
  } else {
    label_isometric(parts, page.projection, labels);
  }
  for (const Text& text : labels.texts()) {
    drawing.shapes.emplace_back(text);
  }
  const double shortened = view == View::kPlan ? 1.0 : kIsometric;
  const PagePoint corner{2.0 * kSceneMargin + 2.0 * kSceneRulerMargin + page.width - 14.0,
                         kSceneTitleHeight + kSceneMargin};
  Legend legend = draw_legend(picture, view, shortened * page.projection.scale, corner);
  append_shapes(std::move(legend.shapes), drawing.shapes);
  drawing.width = corner.x + kLegendWidth;
  const double below = view == View::kPlan ? kSceneRulerMargin : 0.0;
  drawing.height = kSceneTitleHeight + kSceneMargin + std::max(page.height + below, legend.height) +
                   kSceneMargin;
  return drawing;
}

}  // namespace rayloc::draw
