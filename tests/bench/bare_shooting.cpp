#include "tests/bench/bare_shooting.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include <embree3/rtcore.h>

#include "engine/base/parallel.h"
#include "engine/trace/images/fibonacci_lattice.h"

namespace rayloc::bench {
namespace bare_rays {

constexpr std::size_t kStream = 256;  // rays
constexpr float kLeave = 1e-4F;       // [m] of a ray that are skipped after a reflection

struct Vec3f {
  float x, y, z;
};

// Rays as Embree's streams take them.
struct Stream {
  using Floats = std::array<float, kStream>;
  using Numbers = std::array<unsigned, kStream>;

  Stream() {
    mask.fill(~0U);
    instance.fill(RTC_INVALID_GEOMETRY_ID);
  }

  RTCRayHitNp pointers() {
    return {{origin_x.data(),
             origin_y.data(),
             origin_z.data(),
             nearest.data(),
             direction_x.data(),
             direction_y.data(),
             direction_z.data(),
             time.data(),
             farthest.data(),
             mask.data(),
             id.data(),
             flags.data()},
            {normal_x.data(),
             normal_y.data(),
             normal_z.data(),
             u.data(),
             v.data(),
             primitive.data(),
             geometry.data(),
             {instance.data()}}};
  }

  Floats origin_x, origin_y, origin_z, nearest, farthest;
  Floats direction_x, direction_y, direction_z;
  Floats normal_x, normal_y, normal_z, u, v;
  Floats time{};
  Numbers mask{}, id{}, flags{}, primitive{}, geometry{}, instance{};
};

}  // namespace bare_rays

using bare_rays::kLeave;
using bare_rays::kStream;
using bare_rays::Stream;
using bare_rays::Vec3f;

class BareShooting::Impl {
 public:
  explicit Impl(const Scene& scene) : device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr) {
      std::fputs("bare shooting: no Embree\n", stderr);
      std::abort();
    }
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t count = scene.triangle_count();
    auto* corners = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), 3 * count));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), count));
    std::iota(indices, indices + 3 * count, 0U);
    for (const SceneObject& object : scene.objects()) {
      for (const auto& t : object.mesh.triangles) {
        const Vec3d& a = object.mesh.vertices[t[0]];
        const Vec3d& b = object.mesh.vertices[t[1]];
        const Vec3d& c = object.mesh.vertices[t[2]];
        for (const Vec3d& corner : {a, b, c}) {
          *corners++ = rounded(corner);
        }
        normals_.push_back(rounded(normalized(cross(b - a, c - a))));
      }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  std::size_t shoot(const Vec3d& root, const std::vector<Vec3d>& directions, int max_depth) const {
    Stream stream;
    std::size_t segments = 0;
    for (std::size_t first = 0; first < directions.size(); first += kStream) {
      const std::size_t count = std::min(kStream, directions.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3f direction = rounded(directions[first + i]);
        stream.direction_x[i] = direction.x;
        stream.direction_y[i] = direction.y;
        stream.direction_z[i] = direction.z;
      }
      const Vec3f origin = rounded(root);
      std::fill_n(stream.origin_x.begin(), count, origin.x);
      std::fill_n(stream.origin_y.begin(), count, origin.y);
      std::fill_n(stream.origin_z.begin(), count, origin.z);
      segments += bounce(stream, count, max_depth);
    }
    return segments;
  }

 private:
  static Vec3f rounded(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }

  std::size_t bounce(Stream& stream, std::size_t count, int max_depth) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const RTCRayHitNp pointers = stream.pointers();
    std::size_t segments = 0;
    std::size_t alive = count;
    std::fill_n(stream.nearest.begin(), count, 0.0F);
    std::fill_n(stream.farthest.begin(), count, 1e30F);
    for (int depth = 0; depth <= max_depth && alive > 0; ++depth) {
      segments += alive;
      std::fill_n(stream.geometry.begin(), count, RTC_INVALID_GEOMETRY_ID);
      rtcIntersectNp(scene_, &context, &pointers, static_cast<unsigned>(count));
      alive = reflect(stream, count);
    }
    return segments;
  }

  // Turns every ray that has met something; the others are switched off (nearest > farthest).
  std::size_t reflect(Stream& s, std::size_t count) const {
    std::size_t alive = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (s.geometry[i] == RTC_INVALID_GEOMETRY_ID) {
        s.nearest[i] = 1.0F;
        s.farthest[i] = 0.0F;
        continue;
      }
      const Vec3f& n = normals_[s.primitive[i]];
      const float along =
          2.0F * (n.x * s.direction_x[i] + n.y * s.direction_y[i] + n.z * s.direction_z[i]);
      s.origin_x[i] += s.farthest[i] * s.direction_x[i];
      s.origin_y[i] += s.farthest[i] * s.direction_y[i];
      s.origin_z[i] += s.farthest[i] * s.direction_z[i];
      s.direction_x[i] -= along * n.x;
      s.direction_y[i] -= along * n.y;
      s.direction_z[i] -= along * n.z;
      s.nearest[i] = kLeave;
      s.farthest[i] = 1e30F;
      ++alive;
    }
    return alive;
  }

  RTCDevice device_;
  RTCScene scene_ = nullptr;
  std::vector<Vec3f> normals_;  // of each triangle
};

BareShooting::BareShooting(const Scene& scene) : impl_(std::make_unique<const Impl>(scene)) {}
BareShooting::~BareShooting() = default;

std::size_t BareShooting::shoot(const Vec3d& root,
                                const Directions& directions,
                                int max_depth) const {
  std::vector<std::size_t> segments(directions.size());
  parallel_for(directions.size(), 1, [&](std::size_t i) {
    segments[i] = impl_->shoot(root, directions[i], max_depth);
  });
  return std::accumulate(segments.begin(), segments.end(), std::size_t{0});
}

BareShooting::Directions lattice_directions(std::size_t rays) {
  const FibonacciLattice lattice(rays);
  BareShooting::Directions directions(lattice.rings());
  for (std::size_t ring = 0; ring < lattice.rings(); ++ring) {
    lattice.directions(ring, directions[ring]);
  }
  return directions;
}

}  // namespace rayloc::bench
