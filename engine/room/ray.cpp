#include "engine/room/ray.h"

#include <algorithm>

#include "engine/base/constants.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

// rows (I - 2 n n^T), the reflection that comes next on the way from the device
void reflect(Mat3<double>& mirror, const Vec3d& n) {
  for (Vec3d* row : {&mirror.row0, &mirror.row1, &mirror.row2}) {
    *row = *row - 2.0 * dot(*row, n) * n;
  }
}

Vec3<float> single(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

std::vector<Ray> rays_of(const Paths& paths,
                         const RoomModel& room,
                         const Vec3d& device,
                         std::size_t most) {
  std::vector<Ray> rays;
  rays.reserve(paths.size());
  for (const Path& path : paths) {
    Ray ray;
    ray.amplitude = {path.a.re, path.a.im};
    ray.length = path.tau * kSpeedOfLight;
    ray.at_array = path.arrival;
    ray.at_device = path.departure;
    Vec3d from = device;
    Mat3d mirror;
    for (const Interaction& interaction : path.interactions) {
      if (interaction.kind != InteractionKind::kReflection) {
        continue;
      }
      ++ray.reflections;
      if (!room.surface_correction.empty()) {
        ray.amplitude *= room.surface_correction[interaction.surface];
      }
      const Vec3d leg = interaction.position - from;
      const Vec3d normal = room.scene->surfaces()[interaction.surface].plane().normal;
      const double along = dot(leg, normal);
      reflect(mirror, normal);
      ray.cos2_incidence += along * along / dot(leg, leg);
      from = interaction.position;
    }
    ray.mirror = {single(mirror.row0), single(mirror.row1), single(mirror.row2)};
    rays.push_back(ray);
  }
  // Stable, so that rays of equal strength keep the canonical order of the paths.
  std::stable_sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) {
    return std::norm(a.amplitude) > std::norm(b.amplitude);
  });
  if (rays.size() > most) {
    rays.resize(most);
  }
  return rays;
}

}  // namespace rayloc
