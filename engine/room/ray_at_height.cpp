#include "engine/room/ray_at_height.h"

#include <algorithm>

#include "engine/em/antenna_field.h"

namespace rayloc {
namespace {

constexpr double kMinGain = 0.05;   // a ratio, chosen: near a null the ratio is unreliable
constexpr double kMaxChange = 3.0;  // a ratio, chosen: largest change of an amplitude

double gain(const AntennaPattern& pattern,
            const Mat3d& world_from_antenna,
            const Vec3d& direction) {
  return pattern_amplitude(pattern,
                           spherical_basis(transpose_times(world_from_antenna, direction)));
}

}  // namespace

std::vector<Ray> rays_at_height(std::span<const Ray> rays,
                                double by,
                                const DeviceModel& device,
                                const AntennaArray& array) {
  std::vector<Ray> raised(rays.begin(), rays.end());
  if (by == 0.0) {
    return raised;
  }
  const Mat3d upright;
  const Mat3d mounted = rotation(array.pose.orientation);
  for (Ray& ray : raised) {
    const Vec3d path = ray.length * ray.at_device - Vec3d{0.0, 0.0, by};
    const double length = norm(path);
    const Vec3d at_device = (1.0 / length) * path;
    const Vec3<float> back = transpose_times(ray.mirror,
                                             Vec3<float>{static_cast<float>(-at_device.x),
                                                         static_cast<float>(-at_device.y),
                                                         static_cast<float>(-at_device.z)});
    const Vec3d at_array = normalized(Vec3d{
        static_cast<double>(back.x), static_cast<double>(back.y), static_cast<double>(back.z)});
    const auto change = [](double now, double before) {
      return std::max(now, kMinGain) / std::max(before, kMinGain);
    };
    const double factor =
        ray.length / length *
        change(gain(device.pattern, upright, at_device),
               gain(device.pattern, upright, ray.at_device)) *
        change(gain(array.pattern, mounted, at_array), gain(array.pattern, mounted, ray.at_array));
    ray.amplitude *= std::min(factor, kMaxChange);
    ray.length = length;
    ray.at_device = at_device;
    ray.at_array = at_array;
  }
  return raised;
}

}  // namespace rayloc
