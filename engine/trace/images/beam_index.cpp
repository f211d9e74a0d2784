#include "engine/trace/images/beam_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/trace/images/tolerances.h"

namespace rayloc {
namespace {

// A cube is divided down to this half of its side [m], or while it has more beams than this.
constexpr float kMinHalf = 0.15F;
constexpr std::size_t kFewBeams = 32;  // a count, chosen: so few are faster to test than to divide
// Number of beams that are prefetched from memory before their test.
constexpr std::size_t kAhead = 8;

Vec3<float> single(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

float largest(const Vec3<float>& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

BeamBounds::BeamBounds(std::span<const Plane<double>> planes, const Vec3d& root) {
  constexpr float kEverywhere = -1e30F;  // [m], chosen: a plane so far outside removes nothing
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const bool used = i < planes.size();
    const Plane<double> plane = used ? planes[i] : Plane<double>{};
    x[i] = static_cast<float>(plane.normal.x);
    y[i] = static_cast<float>(plane.normal.y);
    z[i] = static_cast<float>(plane.normal.z);
    offset[i] = used ? static_cast<float>(plane.offset - dot(plane.normal, root)) : kEverywhere;
  }
}

bool BeamBounds::meets(const Vec3<float>& from_root, float half, float margin) const {
  // In a form that compilers vectorise: a point outside of a plane sets a sign bit.
  Lanes inside;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    inside[i] = x[i] * from_root.x + y[i] * from_root.y + z[i] * from_root.z - offset[i] +
                half * (std::abs(x[i]) + std::abs(y[i]) + std::abs(z[i])) + margin;
  }
  std::uint32_t signs = 0;
  for (const float value : inside) {
    signs |= std::bit_cast<std::uint32_t>(value);
  }
  return signs >> 31U == 0;
}

bool BeamBounds::meets(const Vec3<float>& from_root, const Vec3<float>& half, float margin) const {
  std::uint32_t signs = 0;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    const float inside = x[i] * from_root.x + y[i] * from_root.y + z[i] * from_root.z - offset[i] +
                         half.x * std::abs(x[i]) + half.y * std::abs(y[i]) +
                         half.z * std::abs(z[i]) + margin;
    signs |= std::bit_cast<std::uint32_t>(inside);
  }
  return signs >> 31U == 0;
}

bool BeamBounds::meets(const Vec3<float>& from,
                       const Vec3<float>& to,
                       float margin,
                       SharesOfSegment& part) const {
  Lanes here;
  Lanes there;
  std::uint32_t outside = 0;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    here[i] = x[i] * from.x + y[i] * from.y + z[i] * from.z - offset[i] + margin;
    there[i] = x[i] * to.x + y[i] * to.y + z[i] * to.z - offset[i] + margin;
    outside |= std::bit_cast<std::uint32_t>(here[i]) & std::bit_cast<std::uint32_t>(there[i]);
  }
  if (outside >> 31U != 0) {
    return false;
  }
  // Fractions are rounded as well.
  constexpr double kRoundedShare = 1e-5;
  part = {};
  for (std::size_t i = 0; i < kPlanes; ++i) {
    if (here[i] < 0.0F || there[i] < 0.0F) {
      const double crossing = static_cast<double>(here[i]) /
                              (static_cast<double>(here[i]) - static_cast<double>(there[i]));
      if (here[i] < 0.0F) {
        part.first = std::max(part.first, crossing - kRoundedShare);
      } else {
        part.last = std::min(part.last, crossing + kRoundedShare);
      }
    }
  }
  return part.first <= part.last;
}

BeamIndex::BeamIndex(std::vector<BeamBounds> beams, const Vec3d& root, const Region& region)
    : beams_(std::move(beams)), root_(root), often_(region.often) {
  const Vec3d centre = 0.5 * (region.lower + region.upper) - root;
  const Vec3d half = 0.5 * (region.upper - region.lower);
  all_.centre = {
      static_cast<float>(centre.x), static_cast<float>(centre.y), static_cast<float>(centre.z)};
  all_.half = static_cast<float>(std::max({half.x, half.y, half.z}));
  all_.beams.resize(beams_.size());
  std::iota(all_.beams.begin(), all_.beams.end(), 0U);
  reach_ = all_.half + largest(all_.centre);
}

std::unique_ptr<const BeamIndex::Cube> BeamIndex::part(const Cube& whole,
                                                       std::size_t octant) const {
  auto part = std::make_unique<Cube>();
  const float half = 0.5F * whole.half;
  const auto shifted = [&](float centre, std::size_t bit) {
    return (octant & bit) != 0 ? centre + half : centre - half;
  };
  part->half = half;
  part->centre = {
      shifted(whole.centre.x, 1), shifted(whole.centre.y, 2), shifted(whole.centre.z, 4)};
  const float margin = kSingleRounding * reach_;
  for (const std::uint32_t beam : whole.beams) {
    if (beams_[beam].meets(part->centre, half, margin)) {
      part->beams.push_back(beam);
    }
  }
  part->beams.shrink_to_fit();
  part->is_leaf = half <= kMinHalf || part->beams.size() <= kFewBeams;
  return part;
}

Vec3<float> BeamIndex::from_root(const Vec3d& point) const { return single(point - root_); }

const BeamIndex::Cube* BeamIndex::cube_at(const Vec3d& point) const {
  const Vec3<float> at = from_root(point);
  if (largest(at - all_.centre) > all_.half) {
    return nullptr;
  }
  const Cube* cube = &all_;
  while (!cube->is_leaf) {
    const std::size_t octant = (at.x > cube->centre.x ? 1U : 0U) |
                               (at.y > cube->centre.y ? 2U : 0U) |
                               (at.z > cube->centre.z ? 4U : 0U);
    cube = &cube->parts[octant].get([&] { return part(*cube, octant); });
  }
  return cube;
}

CubeRegion BeamIndex::region_of(const Cube& cube) const {
  const Vec3d centre{cube.centre.x, cube.centre.y, cube.centre.z};
  return {root_ + centre, static_cast<double>(cube.half + kSingleRounding * reach_)};
}

void BeamIndex::select(const Vec3d& point,
                       std::span<const std::uint32_t> from,
                       std::vector<std::uint32_t>& found) const {
  found.clear();
  const Vec3<float> at = from_root(point);
  const float margin = kSingleRounding * (reach_ + largest(at));
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (i + kAhead < from.size()) {
      const auto* next = reinterpret_cast<const char*>(&beams_[from[i + kAhead]]);
      __builtin_prefetch(next);
      __builtin_prefetch(next + 64);
    }
    if (beams_[from[i]].meets(at, 0.0F, margin)) {
      found.push_back(from[i]);
    }
  }
}

BeamIndex::Segment BeamIndex::segment(const Vec3d& from, const Vec3d& to) const {
  const Vec3<float> start = from_root(from);
  const Vec3<float> end = from_root(to);
  return {start, end, kSingleRounding * (reach_ + std::max(largest(start), largest(end)))};
}

BeamIndex::Box BeamIndex::box(const Vec3d& lower, const Vec3d& upper) const {
  const Vec3<float> centre = from_root(0.5 * (lower + upper));
  const Vec3<float> half = single(0.5 * (upper - lower));
  return {centre, half, kSingleRounding * (reach_ + largest(centre) + largest(half))};
}

std::size_t BeamIndex::bytes(const Cube& cube) {
  std::size_t sum = sizeof(Cube) + cube.beams.capacity() * sizeof(std::uint32_t);
  if (const auto* useful = cube.useful.if_made(); useful != nullptr) {
    sum += useful->capacity() * sizeof(std::uint32_t);
  }
  for (const Lazy<Cube>& part : cube.parts) {
    if (const Cube* made = part.if_made(); made != nullptr) {
      sum += bytes(*made);
    }
  }
  return sum;
}

std::size_t BeamIndex::bytes() const {
  return beams_.capacity() * sizeof(BeamBounds) + bytes(all_);
}

}  // namespace rayloc
