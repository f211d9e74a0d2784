#include "daemon/lab/draw/room_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/draw/labels.h"
#include "daemon/lab/draw/legend.h"
#include "daemon/lab/draw/views.h"
#include "daemon/site/plan/palette.h"
#include "engine/base/check.h"

namespace rayloc::draw {
namespace {

constexpr double kMapMargin = 14.0;
constexpr double kMapTitleHeight = 30.0;
constexpr double kMapRulerMargin = 34.0;
constexpr double kBarWidth = 120.0;
constexpr double kMapMaxWidth = 760.0;  // width of the room on the page
constexpr double kMapMaxHeight = 420.0;
constexpr double kMapMaxPixelsPerMetre = 130.0;
constexpr double kDotRadius = 4.5;
constexpr double kMapTextSize = 10.5;

Colour colour_of(const RoomMap& map, double value) {
  return map.colour(std::clamp((value - map.lowest) / (map.highest - map.lowest), 0.0, 1.0));
}

// From the highest (top) to the lowest value; below it the meaning of a ring.
void draw_colour_bar(const RoomMap& map, const PagePoint& corner, std::vector<Shape>& shapes) {
  constexpr int kBands = 24;
  constexpr int kTicks = 4;
  constexpr double kHeight = 120.0;
  constexpr double kWidth = 14.0;
  shapes.emplace_back(Text{{corner.x, corner.y + 9.0}, map.value_name, kMapTextSize, kInk});
  const double top = corner.y + 18.0;
  for (int i = 0; i < kBands; ++i) {
    const double y = top + i * kHeight / kBands;
    const double below = y + kHeight / kBands;
    const double share = 1.0 - (i + 0.5) / kBands;
    shapes.emplace_back(Polygon{
        {{corner.x, y}, {corner.x + kWidth, y}, {corner.x + kWidth, below}, {corner.x, below}},
        map.colour(share)});
  }
  for (int i = 0; i <= kTicks; ++i) {
    const double share = static_cast<double>(i) / kTicks;
    const double value = map.highest + share * (map.lowest - map.highest);
    shapes.emplace_back(Text{{corner.x + kWidth + 6.0, top + share * kHeight + 3.5},
                             fmt::format("{:.3g}", std::abs(value) < 1e-12 ? 0.0 : value),
                             kMapTextSize,
                             kInk});
  }
  if (!map.ring_meaning.empty()) {
    const PagePoint at{corner.x + 7.0, top + kHeight + 22.0};
    shapes.emplace_back(Circle{at, kDotRadius, {255, 255, 255, 1.0}, Pen{kInk, 1.6}});
    shapes.emplace_back(Text{{at.x + 12.0, at.y + 3.5}, map.ring_meaning, kMapTextSize, kInk});
  }
}

void draw_value_names(const RoomMap& map, const PagePoint& corner, std::vector<Shape>& shapes) {
  constexpr double kRow = 18.0;
  constexpr double kSide = 12.0;
  shapes.emplace_back(Text{{corner.x, corner.y + 9.0}, map.value_name, kMapTextSize, kInk});
  double y = corner.y + 18.0;
  for (const MapName& one : map.names) {
    shapes.emplace_back(Polygon{{{corner.x, y},
                                 {corner.x + kSide, y},
                                 {corner.x + kSide, y + kSide},
                                 {corner.x, y + kSide}},
                                one.colour});
    shapes.emplace_back(
        Text{{corner.x + kSide + 6.0, y + kSide - 2.0}, one.name, kMapTextSize, kInk});
    y += kRow;
  }
}

// Slightly enlarged, so that no seam is visible.
void draw_cells(const RoomMap& map, const Projection& page, std::vector<Shape>& shapes) {
  constexpr double kOverlap = 0.25;  // pixels
  for (const MapCell& cell : map.cells) {
    const double half = 0.5 * cell.side + kOverlap / page.scale;
    shapes.emplace_back(Polygon{{page(cell.middle + Vec3d{-half, -half, 0.0}),
                                 page(cell.middle + Vec3d{half, -half, 0.0}),
                                 page(cell.middle + Vec3d{half, half, 0.0}),
                                 page(cell.middle + Vec3d{-half, half, 0.0})},
                                colour_of(map, cell.value)});
  }
}

void draw_values(const RoomMap& map, const Projection& page, std::vector<Shape>& shapes) {
  for (const MapLine& line : map.lines) {
    shapes.emplace_back(
        Line{{page(line.from), page(line.to)}, {colour_of(map, line.value), map.line_width}});
  }
  const Pen plain{{255, 255, 255, 1.0}, 0.7};
  const Pen ring{kInk, 1.6};
  for (const MapDot& dot : map.dots) {
    shapes.emplace_back(
        Circle{page(dot.at), kDotRadius, colour_of(map, dot.value), dot.ringed ? ring : plain});
  }
  for (const MapAntenna& antenna : map.antennas) {
    append_shapes(draw_antenna(page(antenna.at), MarkKind::kReceiver), shapes);
    Text name{{page(antenna.at).x, page(antenna.at).y - 9.0},
              antenna.name,
              kMapTextSize,
              kReceiverInk,
              TextAnchor::kMiddle};
    name.bold = true;
    name.halo = true;
    shapes.emplace_back(std::move(name));
  }
}

}  // namespace

Drawing draw_room_map(const RoomMap& map) {
  RAYLOC_CHECK(map.scene != nullptr && map.colour != nullptr && map.lowest < map.highest);
  const Bounds all{map.scene->bounds_min(), map.scene->bounds_max()};
  Projection page = plan_projection();
  const Vec3d size = all.size();
  page.scale = std::min({kMapMaxWidth / std::max(size.x, 1e-3),
                         kMapMaxHeight / std::max(size.y, 1e-3),
                         kMapMaxPixelsPerMetre});
  page.origin = {kMapMargin + kMapRulerMargin - page.scale * all.lower.x,
                 kMapMargin + kMapTitleHeight + page.scale * all.upper.y};
  Drawing drawing;
  Text title{{kMapMargin, kMapMargin + 8.0}, map.title, 12.0, kInk};
  title.bold = true;
  drawing.shapes.emplace_back(std::move(title));
  Labels labels;
  const std::vector<Shape> plan = draw_plan(*map.scene, scene_parts(*map.scene), page);
  append_shapes(plan, drawing.shapes);
  append_shapes(draw_ruler(all, page, labels), drawing.shapes);
  if (!map.cells.empty()) {  // objects of the room are drawn over them as lines
    draw_cells(map, page, drawing.shapes);
    std::copy_if(plan.begin(), plan.end(), std::back_inserter(drawing.shapes), [](const Shape& s) {
      return std::holds_alternative<Line>(s);
    });
  }
  draw_values(map, page, drawing.shapes);
  const PagePoint corner{page(all.upper).x + 24.0, kMapMargin + kMapTitleHeight};
  if (map.names.empty()) {
    draw_colour_bar(map, corner, drawing.shapes);
  } else {
    draw_value_names(map, corner, drawing.shapes);
  }
  drawing.width = corner.x + kBarWidth;
  constexpr double kBarHeight = 180.0;
  drawing.height =
      corner.y + std::max(page.scale * size.y + kMapRulerMargin, kBarHeight) + kMapMargin;
  return drawing;
}

}  // namespace rayloc::draw
