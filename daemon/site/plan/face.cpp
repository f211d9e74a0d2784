#include "daemon/site/plan/face.h"

#include <map>
#include <utility>

#include "daemon/site/plan/mesh_section.h"
#include "daemon/site/scene/surface_triangles.h"

namespace rayloc::draw {
namespace {

Edge edge_of(const Vec3d& a, const Vec3d& b) {
  return place_of(a) < place_of(b) ? Edge{place_of(a), place_of(b)}
                                   : Edge{place_of(b), place_of(a)};
}

void add_triangles(const std::vector<Triangle>& triangles, Face face, std::vector<Face>& faces) {
  std::map<Edge, int> uses;
  for (const Triangle& t : triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ++uses[edge_of(t.at(i), t.at((i + 1) % 3))];
    }
  }
  for (const Triangle& t : triangles) {
    face.corners.assign(t.begin(), t.end());
    face.outlined.clear();
    for (std::size_t i = 0; i < 3; ++i) {
      face.outlined.push_back(uses[edge_of(t.at(i), t.at((i + 1) % 3))] == 1);
    }
    faces.push_back(face);
  }
}

}  // namespace

std::vector<Face> scene_faces(const Scene& scene) {
  const auto triangles = surface_triangles(scene);
  std::vector<Face> faces;
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    const Surface& surface = scene.surfaces()[i];
    const Scene::SurfaceOwner& owner = scene.owner(i);
    const Solid& solid = scene.solid(owner.object);
    Face face;
    face.normal = surface.plane().normal;
    face.solid = solid.shells > 0 && owner.one_facing;
    if (face.solid && solid.orientation < 0) {
      face.normal = -face.normal;
    }
    face.object = owner.object;
    if (surface.is_convex()) {
      face.corners = surface.outline();
      face.outlined.assign(face.corners.size(), true);
      faces.push_back(std::move(face));
    } else {
      add_triangles(triangles[i], std::move(face), faces);
    }
  }
  return faces;
}

}  // namespace rayloc::draw
