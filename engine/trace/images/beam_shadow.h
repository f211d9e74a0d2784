// BeamShadow: detects surfaces that certainly block a beam.
//
// A convex piece of a surface hides a window from the beam's apex when it hides every corner. It
// must do so with a margin to its edges and to both ends, so that no rounding or tolerance of a
// later test of a path can change the result, and no soft edge lets a part pass.
#pragma once

#include <cmath>
#include <span>

#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

class BeamShadow {
 public:
  // A beam from a point, or, with `start`, one that leaves a mirror: the plane of the mirror,
  // facing the direction of the beam. `margin` [m], > 0.
  BeamShadow(const Vec3d& apex, const Plane<double>* start, double margin)
      : apex_(apex), start_(start), margin_(margin) {}

  bool hides(const Surface& surface, std::span<const Vec3d> window) const {
    const double apex_distance = distance(surface.plane(), apex_);
    if (start_ == nullptr && std::abs(apex_distance) < margin_) {
      return false;
    }
    for (const Surface::Piece& piece : surface.pieces()) {
      if (hides(surface, piece, apex_distance, window)) {
        return true;
      }
    }
    return false;
  }

 private:
  bool hides(const Surface& surface,
             const Surface::Piece& piece,
             double apex_distance,
             std::span<const Vec3d> window) const {
    for (const Vec3d& corner : window) {
      const double here = distance(surface.plane(), corner);
      if (std::abs(here) < margin_ || (here > 0.0) == (apex_distance > 0.0)) {
        return false;
      }
      const Vec3d crossing = apex_ + (apex_distance / (apex_distance - here)) * (corner - apex_);
      if ((start_ != nullptr && distance(*start_, crossing) < margin_) ||
          !surface.contains(piece, crossing, -margin_)) {
        return false;
      }
    }
    return true;
  }

  Vec3d apex_;
  const Plane<double>* start_;
  double margin_;
};

}  // namespace rayloc
