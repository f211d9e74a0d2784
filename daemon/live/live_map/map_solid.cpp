#include "daemon/live/live_map/map_solid.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/live/live_map/millimetre.h"
#include "daemon/site/plan/isometric_faces.h"
#include "daemon/site/plan/projection.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFacesOfOne = 200;

Json rounded_point(const Vec3d& point) {
  return {to_millimetre(point.x), to_millimetre(point.y), to_millimetre(point.z)};
}

std::vector<draw::Face> box_of(const Bounds& bounds, std::uint32_t object) {
  const auto corner = [&](unsigned at) {
    return Vec3d{(at & 1U) != 0 ? bounds.upper.x : bounds.lower.x,
                 (at & 2U) != 0 ? bounds.upper.y : bounds.lower.y,
                 (at & 4U) != 0 ? bounds.upper.z : bounds.lower.z};
  };
  constexpr std::array<std::array<unsigned, 4>, 6> kSides = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  constexpr std::array<Vec3d, 6> kNormals = {
      {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
  std::vector<draw::Face> faces;
  faces.reserve(kSides.size());
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const auto& [a, b, c, d] = kSides.at(i);
    faces.push_back({{corner(a), corner(b), corner(c), corner(d)},
                     {true, true, true, true},
                     kNormals.at(i),
                     true,
                     object});
  }
  return faces;
}

std::vector<draw::Face> few_faces(const Scene& scene, const std::vector<draw::ScenePart>& parts) {
  std::vector<draw::Face> all = draw::scene_faces(scene);
  std::vector<std::size_t> counts(parts.size());
  for (const draw::Face& face : all) {
    ++counts[face.object];
  }
  std::erase_if(all, [&](const draw::Face& face) { return counts[face.object] > kMaxFacesOfOne; });
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    if (counts[i] > kMaxFacesOfOne) {
      for (draw::Face& side : box_of(parts[i].bounds, i)) {
        all.push_back(std::move(side));
      }
    }
  }
  return all;
}

// The corners, and the edges of the outline that are no seams.
Json face_json(const draw::Face& face) {
  Json corners = Json::array();
  Json edges = Json::array();
  for (std::size_t i = 0; i < face.corners.size(); ++i) {
    corners.push_back(rounded_point(face.corners[i]));
    if (face.outlined[i]) {
      edges.push_back(i);
    }
  }
  return {{"corners", std::move(corners)}, {"edges", std::move(edges)}};
}

}  // namespace

std::string map_solid_json(const Scene& scene) {
  const std::vector<draw::ScenePart> parts = draw::scene_parts(scene);
  const draw::IsometricFaces faces = draw::isometric_faces(
      few_faces(scene, parts), parts, draw::isometric_projection().towards_viewer);
  Json filled = Json::array();
  for (const auto& [face, colour] : faces.filled) {
    Json one = face_json(face);
    one["colour"] = fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
    one["opacity"] = colour.opacity;
    filled.push_back(std::move(one));
  }
  Json open = Json::array();
  for (const draw::Face& face : faces.open) {
    open.push_back(face_json(face));
  }
  Json names = Json::array();
  for (const draw::ScenePart& part : parts) {
    if (part.kind == draw::PartKind::kFurniture) {
      Vec3d top = 0.5 * (part.bounds.lower + part.bounds.upper);
      top.z = part.bounds.upper.z;
      names.push_back({{"name", part.name}, {"at", rounded_point(top)}});
    }
  }
  const Json solid = {
      {"faces", std::move(filled)}, {"open", std::move(open)}, {"names", std::move(names)}};
  return solid.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rayloc
