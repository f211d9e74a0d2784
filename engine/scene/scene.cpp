#include "engine/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/kept.h"
#include "engine/scene/ray_shooter.h"

namespace rayloc {
namespace {

constexpr double kMinHeight = 1e-6;  // [m], of a triangle
// Above this size it is no room, and tolerances are below the rounding of a double [m].
constexpr double kFarthest = 100'000.0;
constexpr double kFarthestPlace = 1e8;  // [m], of coordinates of the earth

bool is_degenerate(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3d ab = mesh.vertices[t[1]] - mesh.vertices[t[0]];
  const Vec3d ac = mesh.vertices[t[2]] - mesh.vertices[t[0]];
  const Vec3d bc = mesh.vertices[t[2]] - mesh.vertices[t[1]];
  const double longest = std::max({norm(ab), norm(ac), norm(bc)});
  return !(norm(cross(ab, ac)) > kMinHeight * longest);
}

std::string in_metres(double x) { return std::to_string(std::llround(x)); }

// The fault of a vertex position; empty: none.
std::string fault_of(const Vec3d& v) {
  if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
    return " has a coordinate that is not a finite number";
  }
  const double furthest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (furthest <= kFarthest) {
    return {};
  }
  // Beyond any meaningful coordinate the digits carry no information.
  if (furthest > kFarthestPlace) {
    return " is further than 100 km from the origin";
  }
  return " is at " + in_metres(v.x) + ", " + in_metres(v.y) + ", " + in_metres(v.z) +
         ", further than 100 km from the origin; coordinates of a map must be made local: add "
         "<translate x=\"" +
         in_metres(-v.x) + "\" y=\"" + in_metres(-v.y) +
         "\" z=\"0\"/> at the end of every <transform name=\"to_world\">, and shift the site's "
         "places alike";
}

Expected<void> check_mesh(const SceneObject& object) {
  const Mesh& mesh = object.mesh;
  const auto refuse = [&](const std::string& what) {
    return bad_input("object '" + object.name + "': " + what);
  };
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (const std::string fault = fault_of(mesh.vertices[i]); !fault.empty()) {
      return refuse("vertex " + std::to_string(i) + fault);
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t index : mesh.triangles[i]) {
      if (index >= mesh.vertices.size()) {
        return refuse("triangle " + std::to_string(i) + " refers to vertex " +
                      std::to_string(index) + " of " + std::to_string(mesh.vertices.size()));
      }
    }
  }
  return {};
}

Expected<void> check_input(const Scene::Input& input) {
  if (input.objects.empty()) {
    return bad_input("the scene has no object; a room needs at least one");
  }
  if (!(input.carrier_hz > 0.0) || !std::isfinite(input.carrier_hz)) {
    return bad_input("the carrier frequency must be more than 0 Hz");
  }
  for (const RadioMaterial& material : input.materials) {
    RAYLOC_TRY(validate(material));
  }
  for (const SceneObject& object : input.objects) {
    if (object.material >= input.materials.size()) {
      return bad_input("object '" + object.name + "' has no material");
    }
    RAYLOC_TRY(check_mesh(object));
  }
  return {};
}

}  // namespace

Expected<Scene> Scene::create(Input input) {
  RAYLOC_TRY(check_input(input));
  std::size_t dropped = 0;
  std::vector<Surface> surfaces;
  std::vector<SurfaceOwner> owners;
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    Mesh& mesh = input.objects[i].mesh;
    dropped += std::erase_if(mesh.triangles, [&](const auto& t) { return is_degenerate(mesh, t); });
    if (mesh.triangles.empty()) {
      return bad_input("object '" + input.objects[i].name +
                       "' has no triangle that is at least a micrometre high");
    }
    for (MeshSurface& found : planar_surfaces(mesh)) {
      surfaces.push_back(std::move(found.surface));
      owners.push_back({static_cast<std::uint32_t>(i), found.one_facing});
    }
  }
  auto bvh = Bvh::create(surfaces);
  RAYLOC_TRY(bvh);
  Scene scene(std::move(input), std::move(surfaces), std::move(owners), std::move(*bvh));
  scene.dropped_triangles_ = dropped;
  return scene;
}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

const RayShooter& Scene::shooter() const {
  return shooter_->get([&] {
    auto made = RayShooter::create(surfaces_);
    RAYLOC_CHECK(made.has_value());  // Embree has already worked for the Bvh
    return std::make_unique<const RayShooter>(std::move(*made));
  });
}

Scene::Scene(Input input, std::vector<Surface> surfaces, std::vector<SurfaceOwner> owners, Bvh bvh)
    : objects_(std::move(input.objects)),
      materials_(std::move(input.materials)),
      carrier_hz_(input.carrier_hz),
      notes_(std::move(input.notes)),
      surfaces_(std::move(surfaces)),
      owners_(std::move(owners)),
      bvh_(std::move(bvh)),
      shooter_(std::make_unique<const Lazy<RayShooter>>()) {
  // [m]: replaced by the first corner.
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  bounds_min_ = {kInfinity, kInfinity, kInfinity};
  bounds_max_ = {-kInfinity, -kInfinity, -kInfinity};
  for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
    while (first_surface_.size() <= owners_[i].object) {
      first_surface_.push_back(i);
    }
  }
  first_surface_.push_back(static_cast<std::uint32_t>(surfaces_.size()));
  for (const SceneObject& object : objects_) {
    solids_.push_back(classify_solid(object.mesh));
    triangle_count_ += object.mesh.triangles.size();
    for (const auto& triangle : object.mesh.triangles) {
      for (const std::uint32_t index : triangle) {
        const Vec3d& v = object.mesh.vertices[index];
        bounds_min_ = {std::min(bounds_min_.x, v.x),
                       std::min(bounds_min_.y, v.y),
                       std::min(bounds_min_.z, v.z)};
        bounds_max_ = {std::max(bounds_max_.x, v.x),
                       std::max(bounds_max_.y, v.y),
                       std::max(bounds_max_.z, v.z)};
      }
    }
  }
}

}  // namespace rayloc
