#include "engine/trace/images/mirror_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "engine/trace/images/tolerances.h"

namespace rayloc {
namespace {

// Winding numbers closer than this to a whole number are rounded to it.
constexpr double kWindingTolerance = 0.01;

// The side of an object's faces that waves from `root` can meet without transmission: that of the
// normal (+1), the other (-1), or both (0).
int lit_side(const Solid& solid, const Mesh& mesh, const Vec3d& root) {
  if (solid.shells == 0) {
    return 0;
  }
  const double around = solid.orientation * winding_number(mesh, root);
  if (std::abs(around) < kWindingTolerance) {
    return solid.orientation;
  }
  const bool inside_single = solid.shells == 1 && std::abs(around - 1.0) < kWindingTolerance;
  return inside_single ? -solid.orientation : 0;
}

double largest_coordinate(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

MirrorTable::MirrorTable(const Scene& scene,
                         std::span<const Vec3d> roots,
                         const TraceOptions& options,
                         std::span<const std::uint32_t> objects)
    : scene_(&scene),
      roots_(roots.begin(), roots.end()),
      outlines_(scene.surfaces().size()),
      side_(scene.surfaces().size() * roots.size()) {
  for (const std::uint32_t object : objects) {
    add_object(object, options);
  }
}

MirrorTable::MirrorTable(const Scene& scene,
                         std::span<const Vec3d> roots,
                         const TraceOptions& options)
    : MirrorTable(scene, roots, options, {}) {
  for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
    add_object(i, options);
  }
  blocks_.resize((outlines_.size() + kBlock - 1) / kBlock);
  for (std::uint32_t i = 0; i < outlines_.size(); ++i) {
    put_into_block(i);
  }
}

void MirrorTable::add_object(std::uint32_t object, const TraceOptions& options) {
  const auto [first, end] = scene_->surfaces_of(object);
  for (std::uint32_t i = first; i < end; ++i) {
    const Surface& surface = scene_->surfaces()[i];
    outlines_[i] = grown(surface.outline(), surface.plane().normal, options.softness + kBeamMargin);
  }
  for (std::size_t root = 0; root < roots_.size() && !options.transmission; ++root) {
    const int side = lit_side(scene_->solid(object), scene_->objects()[object].mesh, roots_[root]);
    for (std::uint32_t i = first; i < end; ++i) {
      side_[i * roots_.size() + root] =
          static_cast<std::int8_t>(scene_->owner(i).one_facing ? side : 0);
    }
  }
}

void MirrorTable::put_into_block(std::uint32_t surface) {
  const Surface& s = scene_->surfaces()[surface];
  std::array<double, 2> u{0.0, 0.0};  // smallest and largest plane coordinate
  std::array<double, 2> v{0.0, 0.0};
  for (const Vec3d& corner : outlines_[surface]) {
    const Vec3d from_origin = corner - s.origin();
    u = {std::min(u[0], dot(s.u_axis(), from_origin)),
         std::max(u[1], dot(s.u_axis(), from_origin))};
    v = {std::min(v[0], dot(s.v_axis(), from_origin)),
         std::max(v[1], dot(s.v_axis(), from_origin))};
    reach_ = std::max(reach_, largest_coordinate(corner - roots_[0]));
  }
  const Vec3d centre = s.origin() + (0.5 * (u[0] + u[1])) * s.u_axis() +
                       (0.5 * (v[0] + v[1])) * s.v_axis() - roots_[0];
  Block& block = blocks_[surface / kBlock];
  const std::size_t lane = surface % kBlock;
  const auto put = [lane](Vectors& to, const Vec3d& value) {
    to.x[lane] = static_cast<float>(value.x);
    to.y[lane] = static_cast<float>(value.y);
    to.z[lane] = static_cast<float>(value.z);
  };
  put(block.centre, centre);
  put(block.half_u, (0.5 * (u[1] - u[0])) * s.u_axis());
  put(block.half_v, (0.5 * (v[1] - v[0])) * s.v_axis());
}

// Bit i: lane i is not wholly outside one of the bounds.
unsigned MirrorTable::within(const Block& block, std::span<const PlaneF> bounds) const {
  const float margin = kSingleRounding * static_cast<float>(reach_);
  alignas(64) Lanes least;
  least.fill(1.0F);
  const auto along = [](const Vectors& v, const PlaneF& n, std::size_t i) {
    return n.x * v.x[i] + n.y * v.y[i] + n.z * v.z[i];
  };
  for (const PlaneF& n : bounds) {
    const float nearest = margin - n.offset;
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float inside = along(block.centre, n, i) + std::abs(along(block.half_u, n, i)) +
                           std::abs(along(block.half_v, n, i)) + nearest;
      least[i] = inside < least[i] ? inside : least[i];
    }
  }
  unsigned mask = 0;
  for (std::size_t i = 0; i < kBlock; ++i) {
    mask |= (least[i] >= 0.0F ? 1U : 0U) << i;
  }
  return mask;
}

void MirrorTable::find(std::span<const Plane<double>> bounds,
                       std::vector<std::uint32_t>& found) const {
  found.clear();
  std::vector<PlaneF> relative;
  relative.reserve(bounds.size());
  for (const auto& [normal, offset] : bounds) {
    relative.push_back({static_cast<float>(normal.x),
                        static_cast<float>(normal.y),
                        static_cast<float>(normal.z),
                        static_cast<float>(offset - dot(normal, roots_[0]))});
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    for (unsigned mask = within(blocks_[i], relative); mask != 0; mask &= mask - 1) {
      const std::size_t surface = kBlock * i + static_cast<std::size_t>(std::countr_zero(mask));
      if (surface < outlines_.size()) {
        found.push_back(static_cast<std::uint32_t>(surface));
      }
    }
  }
}

}  // namespace rayloc
