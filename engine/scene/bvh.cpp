#include "engine/scene/bvh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <embree3/rtcore.h>

#include "engine/base/parallel.h"
#include "engine/scene/embree_error.h"

namespace rayloc {
namespace {

// Boxes are widened by this share of the largest coordinate from the middle of the scene: some 16
// roundings of a float, where origin, direction and traversal together make about 6.
constexpr double kWidening = 2e-6;
// Queries from further away than this many scene sizes would round by more than the widening.
constexpr double kFarAway = 2.0;
// A corner grown by a margin extends further than the margin: by this much where two edges meet at
// 29 degrees; a sharper corner's last tip, of weight almost 0 by all measures, may be missed.
constexpr double kCornerReach = 4.0;

// Data of a query for the callbacks: Embree passes on a pointer to its context.
struct Query {
  RTCIntersectContext context;  // first, so that its address is the query's
  const Segment* segment;
  double length;
  bool blocked;
  std::vector<Crossing>* found;  // nullptr: stop at the first one
};

}  // namespace

class Bvh::Impl {
 public:
  Impl(std::span<const Surface> surfaces, double margin) : surfaces_(surfaces), margin_(margin) {
    // [m]: replaced by the first corner.
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3d lower{kInfinity, kInfinity, kInfinity};
    Vec3d upper = -lower;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const auto& pieces = surfaces[i].pieces();
      for (std::size_t j = 0; j < pieces.size(); ++j) {
        primitives_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
        const Vec3d& low = pieces[j].lower;
        const Vec3d& high = pieces[j].upper;
        lower = {std::min(lower.x, low.x), std::min(lower.y, low.y), std::min(lower.z, low.z)};
        upper = {std::max(upper.x, high.x), std::max(upper.y, high.y), std::max(upper.z, high.z)};
      }
    }
    if (!primitives_.empty()) {
      // Whole metres, as in RayShooter: round numbers of the scene stay round.
      const Vec3d middle = 0.5 * (lower + upper);
      origin_ = {std::round(middle.x), std::round(middle.y), std::round(middle.z)};
    }
    const Vec3d half = upper - origin_;
    const double reach = std::max({1.0, half.x + 1.0, half.y + 1.0, half.z + 1.0});
    largest_coordinate_ = kFarAway * reach;
    widening_ = kWidening * largest_coordinate_ + kCornerReach * margin;
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
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(primitives_.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &Impl::bounds, nullptr);
    rtcSetGeometryOccludedFunction(geometry, &Impl::occluded);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    serially([&] { rtcCommitScene(scene_); });
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
      return embree_error(error);
    }
    return {};
  }

  bool is_blocked(const Segment& segment) const { return ask(segment, nullptr); }

  void crossings(const Segment& segment, std::vector<Crossing>& found) const {
    found.clear();
    ask(segment, &found);
    std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) {
      return std::tie(a.share, a.surface) < std::tie(b.share, b.surface);
    });
  }

 private:
  struct Primitive {
    std::uint32_t surface;
    std::uint32_t piece;
  };

  bool ask(const Segment& segment, std::vector<Crossing>* found) const {
    const Vec3d along = segment.to - segment.from;
    Query query{};
    rtcInitIntersectContext(&query.context);
    query.segment = &segment;
    query.length = norm(along);
    query.found = found;
    const Vec3d from = segment.from - origin_;
    for (const Vec3d& end : {from, segment.to - origin_}) {
      if (std::max({std::abs(end.x), std::abs(end.y), std::abs(end.z)}) > largest_coordinate_) {
        for (const Primitive& primitive : primitives_) {
          if (meet(query, primitive)) {
            break;
          }
        }
        return query.blocked;
      }
    }
    RTCRay ray{};
    ray.org_x = static_cast<float>(from.x);
    ray.org_y = static_cast<float>(from.y);
    ray.org_z = static_cast<float>(from.z);
    ray.dir_x = static_cast<float>(along.x);
    ray.dir_y = static_cast<float>(along.y);
    ray.dir_z = static_cast<float>(along.z);
    ray.tfar = 1.0F;
    ray.mask = 0xffffffffU;
    rtcOccluded1(scene_, &query.context, &ray);
    return query.blocked;
  }

  // True if this piece completes the query.
  bool meet(Query& query, const Primitive& primitive) const {
    const double share = crossing(query, primitive);
    if (share < 0.0) {
      return false;
    }
    query.blocked = true;
    if (query.found == nullptr) {
      return true;
    }
    const bool known =
        std::any_of(query.found->begin(), query.found->end(), [&](const Crossing& c) {
          return c.surface == primitive.surface;  // by another of its pieces
        });
    if (!known) {
      query.found->push_back({primitive.surface, share});
    }
    return false;
  }

  // The decision in double precision: the share of the segment, or -1 for none.
  double crossing(const Query& query, const Primitive& primitive) const {
    const Segment& s = *query.segment;
    constexpr double kNoCrossing = -1.0;  // no share of a segment, which lies between 0 and 1
    if (primitive.surface == s.from_surface || primitive.surface == s.to_surface) {
      return kNoCrossing;
    }
    const Surface& surface = surfaces_[primitive.surface];
    const double from = distance(surface.plane(), s.from);
    const double to = distance(surface.plane(), s.to);
    if ((from > 0.0) == (to > 0.0) || from == to) {
      return kNoCrossing;
    }
    const double share = from / (from - to);
    if (share * query.length <= kEndTolerance || (1.0 - share) * query.length <= kEndTolerance) {
      return kNoCrossing;
    }
    const Vec3d point = s.from + share * (s.to - s.from);
    return surface.contains(surface.pieces()[primitive.piece], point, margin_) ? share
                                                                               : kNoCrossing;
  }

  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto* self = static_cast<const Impl*>(arguments->geometryUserPtr);
    const Primitive& primitive = self->primitives_[arguments->primID];
    const Surface::Piece& piece = self->surfaces_[primitive.surface].pieces()[primitive.piece];
    const Vec3d wider{self->widening_, self->widening_, self->widening_};
    const Vec3d lower = piece.lower - self->origin_ - wider;
    const Vec3d upper = piece.upper - self->origin_ + wider;
    RTCBounds* box = arguments->bounds_o;
    box->lower_x = static_cast<float>(lower.x);
    box->lower_y = static_cast<float>(lower.y);
    box->lower_z = static_cast<float>(lower.z);
    box->upper_x = static_cast<float>(upper.x);
    box->upper_y = static_cast<float>(upper.y);
    box->upper_z = static_cast<float>(upper.z);
  }

  static void occluded(const RTCOccludedFunctionNArguments* arguments) {
    const auto* self = static_cast<const Impl*>(arguments->geometryUserPtr);
    auto* query = reinterpret_cast<Query*>(arguments->context);
    if (arguments->valid[0] == 0 || !self->meet(*query, self->primitives_[arguments->primID])) {
      return;
    }
    // Embree's sign for "hit, stop": tfar = -infinity. N is 1: only rtcOccluded1 is called.
    reinterpret_cast<RTCRay*>(arguments->ray)->tfar = -std::numeric_limits<float>::infinity();
  }

  std::span<const Surface> surfaces_;
  std::vector<Primitive> primitives_;
  Vec3d origin_;                     // origin of single-precision coordinates, world
  double largest_coordinate_ = 0.0;  // [m], relative to it
  double widening_ = 0.0;            // [m]
  double margin_ = 0.0;              // [m]
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

Expected<Bvh> Bvh::create(std::span<const Surface> surfaces, double margin) {
  auto impl = std::make_unique<Impl>(surfaces, margin);
  RAYLOC_TRY(impl->build());
  return Bvh(std::move(impl));
}

Bvh::Bvh(std::unique_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Bvh::~Bvh() = default;
Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;

bool Bvh::is_blocked(const Segment& segment) const { return impl_->is_blocked(segment); }

void Bvh::crossings(const Segment& segment, std::vector<Crossing>& found) const {
  impl_->crossings(segment, found);
}

}  // namespace rayloc
