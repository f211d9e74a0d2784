#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "daemon/lab/draw/views.h"
#include "daemon/site/plan/face.h"
#include "daemon/site/plan/isometric_faces.h"
#include "daemon/site/plan/palette.h"

namespace rayloc::draw {
namespace {

constexpr Pen kEdge{kFaintInk, 0.7};
constexpr Pen kOpenEdge{{130, 130, 130, 1.0}, 0.8, true};

void draw_edges(const Face& face,
                const std::vector<PagePoint>& corners,
                const Pen& pen,
                std::vector<Shape>& shapes) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (face.outlined[i]) {
      shapes.emplace_back(Line{{corners[i], corners[(i + 1) % corners.size()]}, pen});
    }
  }
}

std::vector<PagePoint> face_on_page(const Face& face, const Projection& page) {
  std::vector<PagePoint> corners;
  corners.reserve(face.corners.size());
  for (const Vec3d& corner : face.corners) {
    corners.push_back(page(corner));
  }
  return corners;
}

}  // namespace

std::vector<Shape> draw_isometric(const Scene& scene,
                                  const std::vector<ScenePart>& parts,
                                  const Projection& page) {
  const IsometricFaces faces = isometric_faces(scene_faces(scene), parts, page.towards_viewer);
  std::vector<Shape> shapes;
  for (const auto& [face, colour] : faces.filled) {
    const std::vector<PagePoint> corners = face_on_page(face, page);
    shapes.emplace_back(Polygon{corners, colour});
    draw_edges(face, corners, kEdge, shapes);
  }
  for (const Face& face : faces.open) {
    draw_edges(face, face_on_page(face, page), kOpenEdge, shapes);
  }
  return shapes;
}

void label_isometric(const std::vector<ScenePart>& parts, const Projection& page, Labels& labels) {
  std::vector<const ScenePart*> nearest_first;
  for (const ScenePart& part : parts) {
    if (part.kind == PartKind::kFurniture) {
      nearest_first.push_back(&part);
    }
  }
  const auto nearness = [&](const ScenePart& part) {
    return dot(page.towards_viewer, part.bounds.lower + part.bounds.upper);
  };
  std::stable_sort(nearest_first.begin(), nearest_first.end(), [&](const auto* a, const auto* b) {
    return nearness(*a) > nearness(*b);
  });
  for (const ScenePart* part : nearest_first) {
    Vec3d top = 0.5 * (part->bounds.lower + part->bounds.upper);
    const PagePoint middle = page(top);
    top.z = part->bounds.upper.z;
    std::vector<Text> places;
    for (const double size : {10.0, 8.0}) {
      Text text{page(top), part->name, size, kInk, TextAnchor::kMiddle};
      text.halo = true;
      text.at.y += 0.35 * size;
      places.push_back(text);
      places.back().at.y = middle.y + 0.35 * size;
      for (const double shift : {-0.9 * size, 1.1 * size}) {
        places.push_back(text);
        places.back().at.y += shift;
      }
    }
    labels.place(places);
  }
}

std::vector<Shape> draw_axes(const PagePoint& corner) {
  constexpr double kLength = 26.0;
  Projection page = isometric_projection();
  page.scale = kLength / kIsometric;
  page.origin = corner;
  std::vector<Shape> shapes;
  for (const auto& [name, axis] : {std::pair("x", Vec3d{1, 0, 0}),
                                   std::pair("y", Vec3d{0, 1, 0}),
                                   std::pair("z", Vec3d{0, 0, 1})}) {
    PagePoint beyond = page(1.35 * axis);
    beyond.y += 3.5;
    shapes.emplace_back(Line{{corner, page(axis)}, {kInk, 1.2}});
    shapes.emplace_back(Text{beyond, name, 10.0, kInk, TextAnchor::kMiddle});
  }
  return shapes;
}

}  // namespace rayloc::draw
