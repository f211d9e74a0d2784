#include "engine/scene/ray_shooter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <embree3/rtcore.h>

#include "engine/base/parallel.h"
#include "engine/scene/embree_error.h"
#include "engine/scene/piece_corners.h"

namespace rayloc {
namespace {

// Share of the largest coordinate: some 160 roundings of a float.
constexpr float kClearance = 1e-5F;

}  // namespace

class RayShooter::Impl {
 public:
  explicit Impl(std::span<const Surface> surfaces) {
    // [m]: replaced by the first corner.
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3d lower{kInfinity, kInfinity, kInfinity};
    Vec3d upper = -lower;
    for (const Surface& surface : surfaces) {
      for (const Vec3d& c : surface.outline()) {
        lower = {std::min(lower.x, c.x), std::min(lower.y, c.y), std::min(lower.z, c.z)};
        upper = {std::max(upper.x, c.x), std::max(upper.y, c.y), std::max(upper.z, c.z)};
      }
    }
    // Whole metres: round numbers of the scene stay round, which is faster in Embree where surfaces
    // touch (a floor of 100 000 triangles: 1.3 times the rays).
    const Vec3d centre = 0.5 * (lower + upper);
    origin_ = {std::round(centre.x), std::round(centre.y), std::round(centre.z)};
    const Vec3d half = upper - origin_;
    clearance_ = kClearance * static_cast<float>(std::max({half.x, half.y, half.z}));
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      add(surfaces[i], static_cast<std::uint32_t>(i));
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  Expected<void> build() {
    // Never "threads=1": with TBB that would hold for the whole process.
    device_ = rtcNewDevice(nullptr);
    if (device_ == nullptr) {
      return embree_error(rtcGetDeviceError(nullptr));
    }
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<Corner*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Corner), corners_.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry,
                                                                   RTC_BUFFER_TYPE_INDEX,
                                                                   0,
                                                                   RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned),
                                                                   triangles_.size()));
    if (corners != nullptr && indices != nullptr) {
      std::copy(corners_.begin(), corners_.end(), corners);
      for (unsigned i = 0; i < 3 * triangles_.size(); ++i) {
        indices[i] = i;
      }
    }
    corners_ = {};
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    serially([&] { rtcCommitScene(scene_); });
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
      return embree_error(error);
    }
    return {};
  }

  void shoot(RayStream& stream, float nearest) const {
    // Further fields that Embree requires; unused results share an array.
    struct Rest {
      alignas(64) RayStream::Lanes<float> nearest, time, unread;
      alignas(64) RayStream::Lanes<unsigned> mask, number, flags, geometry, instance;
    };
    Rest rest;
    const std::size_t n = stream.size;
    std::fill_n(rest.nearest.begin(), n, nearest);
    std::fill_n(rest.time.begin(), n, 0.0F);
    std::fill_n(rest.mask.begin(), n, ~0U);
    std::fill_n(rest.flags.begin(), n, 0U);
    std::fill_n(rest.geometry.begin(), n, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(rest.instance.begin(), n, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(stream.distance.begin(), n, std::numeric_limits<float>::infinity());
    std::fill_n(stream.triangle.begin(), n, kNoTriangle);
    const RTCRayHitNp rays{{stream.origin_x.data(),
                            stream.origin_y.data(),
                            stream.origin_z.data(),
                            rest.nearest.data(),
                            stream.direction_x.data(),
                            stream.direction_y.data(),
                            stream.direction_z.data(),
                            rest.time.data(),
                            stream.distance.data(),
                            rest.mask.data(),
                            rest.number.data(),
                            rest.flags.data()},
                           {rest.unread.data(),
                            rest.unread.data(),
                            rest.unread.data(),
                            rest.unread.data(),
                            rest.unread.data(),
                            stream.triangle.data(),
                            rest.geometry.data(),
                            {rest.instance.data()}}};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersectNp(scene_, &context, &rays, static_cast<unsigned>(n));
  }

  std::span<const Triangle> triangles() const { return triangles_; }
  const Vec3d& origin() const { return origin_; }
  float clearance() const { return clearance_; }

 private:
  struct Corner {
    float x, y, z;
  };

  void add(const Surface& surface, std::uint32_t number) {
    const Vec3d& normal = surface.plane().normal;
    for (const Surface::Piece& piece : surface.pieces()) {
      const std::vector<Vec3d> corners = piece_corners(surface, piece);
      for (std::size_t i = 2; i < corners.size(); ++i) {
        for (const Vec3d& corner : {corners[0], corners[i - 1], corners[i]}) {
          const Vec3d from_origin = corner - origin_;
          corners_.push_back({static_cast<float>(from_origin.x),
                              static_cast<float>(from_origin.y),
                              static_cast<float>(from_origin.z)});
        }
        triangles_.push_back({static_cast<float>(normal.x),
                              static_cast<float>(normal.y),
                              static_cast<float>(normal.z),
                              number});
      }
    }
  }

  Vec3d origin_;
  float clearance_ = 0.0F;
  std::vector<Corner> corners_;  // three per triangle, until Embree has them
  std::vector<Triangle> triangles_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

Expected<RayShooter> RayShooter::create(std::span<const Surface> surfaces) {
  auto impl = std::make_unique<Impl>(surfaces);
  RAYLOC_TRY(impl->build());
  return RayShooter(std::move(impl));
}

RayShooter::RayShooter(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
RayShooter::~RayShooter() = default;
RayShooter::RayShooter(RayShooter&&) noexcept = default;
RayShooter& RayShooter::operator=(RayShooter&&) noexcept = default;

void RayShooter::shoot(RayStream& stream, float nearest) const { impl_->shoot(stream, nearest); }
std::span<const RayShooter::Triangle> RayShooter::triangles() const { return impl_->triangles(); }
const Vec3d& RayShooter::origin() const { return impl_->origin(); }
float RayShooter::clearance() const { return impl_->clearance(); }

}  // namespace rayloc
