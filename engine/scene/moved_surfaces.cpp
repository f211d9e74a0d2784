#include "engine/scene/moved_surfaces.h"

#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Displacement of a vertex from the offsets of all surfaces of one object whose planes contain it.
Vec3d displacement(const Scene& scene,
                   std::span<const double> offset,
                   std::uint32_t object,
                   const Vec3d& vertex) {
  const double tolerance = coplanar_tolerance(scene.objects()[object].mesh);
  const auto [first, end] = scene.surfaces_of(object);
  std::vector<std::uint32_t> touched;
  for (std::uint32_t s = first; s < end; ++s) {
    if (std::abs(distance(scene.surfaces()[s].plane(), vertex)) <= tolerance) {
      touched.push_back(s);
    }
  }
  if (touched.empty()) {
    return {};
  }
  Eigen::MatrixXd normals(static_cast<Eigen::Index>(touched.size()), 3);
  Eigen::VectorXd wanted(normals.rows());
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    const std::uint32_t s = touched[static_cast<std::size_t>(i)];
    const Vec3d& n = scene.surfaces()[s].plane().normal;
    normals.row(i) << n.x, n.y, n.z;
    wanted(i) = offset[s];
  }
  const Eigen::Vector3d d =
      normals.jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV).solve(wanted);
  return {d.x(), d.y(), d.z()};
}

}  // namespace

Expected<Scene> move_surfaces(const Scene& scene, std::span<const double> offset) {
  RAYLOC_CHECK(offset.size() == scene.surfaces().size());
  Scene::Input input{scene.objects(), scene.materials(), scene.carrier_hz()};
  for (std::uint32_t object = 0; object < input.objects.size(); ++object) {
    for (Vec3d& vertex : input.objects[object].mesh.vertices) {
      vertex = vertex + displacement(scene, offset, object, vertex);
    }
  }
  return Scene::create(std::move(input));
}

}  // namespace rayloc
