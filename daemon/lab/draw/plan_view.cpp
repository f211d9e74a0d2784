#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/draw/views.h"
#include "daemon/site/plan/floor_plan.h"
#include "daemon/site/plan/palette.h"

namespace rayloc::draw {
namespace {

constexpr Pen kThin{kFaintInk, 0.7};
constexpr Pen kOverhead{kFaintInk, 0.7, true};
constexpr double kWallPen = 2.2;

std::vector<PagePoint> points_on_page(const std::vector<Vec3d>& points, const Projection& page) {
  std::vector<PagePoint> result;
  result.reserve(points.size());
  for (const Vec3d& p : points) {
    result.push_back(page(p));
  }
  return result;
}

void draw_face(const Face& face,
               const Colour& colour,
               const Projection& page,
               std::vector<Shape>& shapes) {
  const std::vector<PagePoint> corners = points_on_page(face.corners, page);
  shapes.emplace_back(Polygon{corners, colour});
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (face.outlined[i]) {
      shapes.emplace_back(Line{{corners[i], corners[(i + 1) % corners.size()]}, kThin});
    }
  }
}

void draw_below(const FloorPlan& plan,
                const std::vector<ScenePart>& parts,
                const Projection& page,
                std::vector<Shape>& shapes) {
  for (const Face& face : plan.below) {
    const ScenePart& part = parts[face.object];
    Colour colour = material_colour(part.material);
    if (part.kind == PartKind::kFloor) {  // pale: the background of all other objects
      colour = {246, 246, 244, 1.0};
    }
    draw_face(face, colour, page, shapes);
  }
}

// Bodies filled, sheets as thick lines.
void draw_cut(const MeshSection& section,
              const ScenePart& part,
              const Projection& page,
              std::vector<Shape>& shapes) {
  const Colour dark = shaded(material_colour(part.material), 0.62);
  for (const auto& loop : section.loops) {
    std::vector<PagePoint> corners = points_on_page(loop, page);
    shapes.emplace_back(Polygon{corners, shaded(material_colour(part.material), 0.85)});
    corners.push_back(corners.front());
    shapes.emplace_back(Line{std::move(corners), {kInk, 0.9}});
  }
  for (const auto& line : section.lines) {
    shapes.emplace_back(
        Line{points_on_page(line, page), {{dark.red, dark.green, dark.blue, 1.0}, kWallPen}});
  }
}

void draw_overhead(const ScenePart& part, const Projection& page, std::vector<Shape>& shapes) {
  const Vec3d& low = part.bounds.lower;
  const Vec3d& high = part.bounds.upper;
  shapes.emplace_back(Line{points_on_page({{low.x, low.y, high.z},
                                           {high.x, low.y, high.z},
                                           {high.x, high.y, high.z},
                                           {low.x, high.y, high.z},
                                           {low.x, low.y, high.z}},
                                          page),
                           kOverhead});
}

// The side of the plan of a wall: 0..3 = west, east, south, north; 4: none, it is inside.
std::size_t side_of(const ScenePart& part, const Bounds& all) {
  constexpr double kAtTheEdge = 0.3;  // [m]
  const Vec3d size = part.bounds.size();
  const bool along_y = size.y > size.x;
  const std::array<double, 4> gaps = {part.bounds.upper.x - all.lower.x,
                                      all.upper.x - part.bounds.lower.x,
                                      part.bounds.upper.y - all.lower.y,
                                      all.upper.y - part.bounds.lower.y};
  for (std::size_t side = along_y ? 0 : 2; side < (along_y ? 2U : 4U); ++side) {
    if (gaps.at(side) <= kAtTheEdge) {
      return side;
    }
  }
  return 4;
}

void label_wall(const ScenePart& part, const Bounds& all, const Projection& page, Labels& labels) {
  constexpr double kBeyondRuler = 30.0;
  constexpr double kBeside = 7.0;
  const std::size_t side = side_of(part, all);
  if (side == 4) {
    return;
  }
  const Vec3d middle = 0.5 * (part.bounds.lower + part.bounds.upper);
  const PagePoint centre = page(middle);
  const PagePoint low = page(all.lower);
  const PagePoint high = page(all.upper);
  Text text{centre, part.name, 10.0, kFaintInk, TextAnchor::kMiddle};
  switch (side) {
    case 0:
      text.at.x = low.x - kBeyondRuler;
      text.degrees = 90.0;
      break;
    case 1:
      text.at.x = high.x + kBeside + text.size;
      text.degrees = 90.0;
      break;
    case 2:
      text.at.y = low.y + kBeyondRuler + text.size;
      break;
    default:
      text.at.y = high.y - kBeside;
  }
  labels.place({text});
}

// Candidate places for the name of a piece of furniture: on it, else above or below; for objects
// too thin to be written on, beside them, on the side of the room.
std::vector<Text> furniture_places(const ScenePart& part,
                                   const PagePoint& room_centre,
                                   const Projection& page,
                                   double size) {
  constexpr double kTooThin = 8.0;  // pixels
  const PagePoint low = page(part.bounds.lower);
  const PagePoint high = page(part.bounds.upper);
  const double width = high.x - low.x;
  const double height = low.y - high.y;
  const PagePoint centre{0.5 * (low.x + high.x), 0.5 * (low.y + high.y)};
  const double length = text_width(part.name, size);
  Text level{{centre.x, centre.y + 0.35 * size}, part.name, size, kInk, TextAnchor::kMiddle};
  level.halo = true;
  Text upright = level;
  upright.at = {centre.x + 0.35 * size, centre.y};
  upright.degrees = 90.0;
  if (width < kTooThin && height > width) {
    upright.at.x = centre.x < room_centre.x ? high.x + size + 1.0 : low.x - 4.0;
    return {upright};
  }
  if (height < kTooThin) {
    level.at.y = centre.y < room_centre.y ? low.y + size + 1.0 : high.y - 4.0;
    return {level};
  }
  std::vector<Text> places;
  if (height > length && width < length) {
    places.push_back(upright);
  }
  if (width > 0.6 * length) {
    places.push_back(level);
  }
  for (const double y : {high.y - 3.0, low.y + size + 1.0}) {
    places.push_back(level);
    places.back().at.y = y;
  }
  return places;
}

void label_furniture(const ScenePart& part,
                     const Bounds& all,
                     const Projection& page,
                     Labels& labels) {
  const PagePoint room_centre = page(0.5 * (all.lower + all.upper));
  std::vector<Text> places;
  for (const double size : {10.0, 8.0}) {
    for (Text& text : furniture_places(part, room_centre, page, size)) {
      places.push_back(std::move(text));
    }
  }
  labels.place(places);
}

}  // namespace

std::vector<Shape> draw_plan(const Scene& scene,
                             const std::vector<ScenePart>& parts,
                             const Projection& page) {
  const FloorPlan plan = floor_plan(scene, parts);
  std::vector<Shape> shapes;
  draw_below(plan, parts, page, shapes);
  // In the order of the objects, so that a picture is always the same.
  std::size_t cut = 0;
  std::size_t overhead = 0;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    if (cut < plan.cuts.size() && plan.cuts[cut].object == i) {
      draw_cut(plan.cuts[cut++].section, parts[i], page, shapes);
    } else if (overhead < plan.overhead.size() && plan.overhead[overhead] == i) {
      draw_overhead(parts[i], page, shapes);
      ++overhead;
    }
  }
  return shapes;
}

void label_plan(const std::vector<ScenePart>& parts,
                const Bounds& all,
                const Projection& page,
                Labels& labels) {
  std::vector<const ScenePart*> largest_first;
  largest_first.reserve(parts.size());
  for (const ScenePart& part : parts) {
    largest_first.push_back(&part);
  }
  const auto area = [](const ScenePart& part) {
    return part.bounds.size().x * part.bounds.size().y;
  };
  std::stable_sort(largest_first.begin(), largest_first.end(), [&](const auto* a, const auto* b) {
    return area(*a) > area(*b);
  });
  for (const ScenePart* part : largest_first) {
    if (part->kind == PartKind::kWall) {
      label_wall(*part, all, page, labels);
    } else if (part->kind == PartKind::kFurniture) {
      label_furniture(*part, all, page, labels);
    }
  }
}

std::vector<Shape> draw_ruler(const Bounds& all, const Projection& page, Labels& labels) {
  constexpr double kTick = 4.0;
  constexpr double kClosest = 36.0;  // pixels between ruler numbers
  constexpr std::array<double, 8> kSteps = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0};
  const auto step = std::find_if(kSteps.begin(), kSteps.end() - 1, [&](double metres) {
    return metres * page.scale >= kClosest;
  });
  const PagePoint low = page(all.lower);
  std::vector<Shape> shapes;
  const auto add = [&](const PagePoint& tick, const PagePoint& end, Text text) {
    shapes.emplace_back(Line{{tick, end}, kThin});
    labels.reserve(text);
    shapes.emplace_back(std::move(text));
  };
  const auto first = [&](double from) { return static_cast<int>(std::ceil(from / *step - 1e-6)); };
  const auto last = [&](double to) { return static_cast<int>(std::floor(to / *step + 1e-6)); };
  for (int i = first(all.lower.x); i <= last(all.upper.x); ++i) {
    const double x = page({i * *step, 0, 0}).x;
    add({x, low.y + 3.0},
        {x, low.y + 3.0 + kTick},
        {{x, low.y + 18.0}, fmt::format("{:g}", i * *step), 9.0, kFaintInk, TextAnchor::kMiddle});
  }
  for (int i = first(all.lower.y); i <= last(all.upper.y); ++i) {
    const double y = page({0, i * *step, 0}).y;
    add({low.x - 3.0, y},
        {low.x - 3.0 - kTick, y},
        {{low.x - 10.0, y + 3.0},
         fmt::format("{:g}", i * *step),
         9.0,
         kFaintInk,
         TextAnchor::kEnd});
  }
  return shapes;
}

}  // namespace rayloc::draw
