#include "engine/room/ray.h"

#include <algorithm>
#include <cstddef>

#include "engine/base/constants.h"
#include "engine/room/surface_correction.h"
#include "engine/scene/scene.h"
#include "engine/trace/interactions/interaction.h"

namespace rayloc {
namespace {

Vec3<float> single(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Follows a path from the device and records the effect of its mirrors in its ray.
class RayFollower {
 public:
  RayFollower(const Scene& scene, const Vec3d& device) : scene_(scene), from_(device) {}

  void meet(interactions::Reflection /*met*/, const Interaction& interaction, Ray& ray) {
    const Vec3d leg = interaction.position - from_;
    const Vec3d normal = scene_.surfaces()[interaction.surface].plane().normal;
    const double along = dot(leg, normal);
    // rows (I - 2 n n^T), the next reflection on the path from the device
    for (Vec3d* row : {&mirror_.row0, &mirror_.row1, &mirror_.row2}) {
      *row = *row - 2.0 * dot(*row, normal) * normal;
    }
    ++ray.reflections;
    ray.cos2_incidence += along * along / dot(leg, leg);
    from_ = interaction.position;
  }
  // Direction unchanged.
  void meet(interactions::Transmission /*met*/, const Interaction& /*interaction*/, Ray& /*ray*/) {}
  void meet(interactions::Shadowing /*met*/, const Interaction& /*interaction*/, Ray& /*ray*/) {}
  // Does not occur: paths of a calibrated room have no diffraction, which has no mirror image.
  void meet(interactions::Diffraction /*met*/, const Interaction& /*interaction*/, Ray& /*ray*/) {}

  Mat3<float> mirror() const {
    return {single(mirror_.row0), single(mirror_.row1), single(mirror_.row2)};
  }

 private:
  const Scene& scene_;
  Vec3d from_;  // [m], the last mirror's point
  Mat3d mirror_;
};

}  // namespace

std::vector<Ray> rays_of(const Paths& paths,
                         const RoomModel& room,
                         const Vec3d& device,
                         std::size_t most) {
  std::vector<Ray> rays;
  rays.reserve(paths.size());
  for (const Path& path : paths) {
    Ray ray;
    ray.amplitude = apply_surface_correction(room.surface_correction, path, {path.a.re, path.a.im});
    ray.length = path.tau * kSpeedOfLight;
    ray.at_array = path.arrival;
    ray.at_device = path.departure;
    RayFollower follower(*room.scene, device);
    for (const Interaction& interaction : path.interactions) {
      visit_interaction(interaction.kind, [&](auto met) { follower.meet(met, interaction, ray); });
    }
    ray.mirror = follower.mirror();
    rays.push_back(ray);
  }
  // Stable, so that rays of equal strength keep the canonical order of the paths.
  std::stable_sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) {
    return std::norm(a.amplitude) > std::norm(b.amplitude);
  });
  if (rays.size() <= most) {
    return rays;
  }
  // A copy: maps keep the rays of every cell, without room for those left out.
  return {rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(most)};
}

}  // namespace rayloc
