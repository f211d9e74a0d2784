#include "engine/scene/wedges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/scene/bounds.h"
#include "engine/scene/piece_corners.h"
#include "engine/scene/surface.h"

namespace rayloc {
namespace {

// Planes with a smaller difference are one (surface.h), so twice as much is an edge [rad].
constexpr double kFlat = 2e-3;
// Distance from an edge at which faces are tested, in tolerances.
constexpr double kBeside = 8.0;
// Shorter pieces of an edge are dropped, in tolerances: a tenth of a millimetre.
constexpr double kShortest = 10.0;

bool apart(const Bounds& a, const Bounds& b, double tolerance) {
  return a.lower.x > b.upper.x + tolerance || b.lower.x > a.upper.x + tolerance ||
         a.lower.y > b.upper.y + tolerance || b.lower.y > a.upper.y + tolerance ||
         a.lower.z > b.upper.z + tolerance || b.lower.z > a.upper.z + tolerance;
}

// A surface on one side of an edge.
struct HalfPlane {
  double azimuth = 0.0;  // [rad], in [0, 2 pi)
  Vec3d direction;       // unit, from the edge
  std::uint32_t surface = 0;
};

class WedgeFinder {
 public:
  explicit WedgeFinder(const Scene& scene) : surfaces_(scene.surfaces()) {
    for (const SceneObject& object : scene.objects()) {
      tolerance_ = std::max(tolerance_, coplanar_tolerance(object.mesh));
    }
    boxes_.reserve(surfaces_.size());
    for (const Surface& surface : surfaces_) {
      Bounds box;
      for (const Vec3d& corner : surface.outline()) {
        box.include(corner);
      }
      boxes_.push_back(box);
    }
  }

  std::vector<Wedge> of(std::uint32_t number) const {
    std::vector<Wedge> found;
    for (const Surface::Piece& piece : surfaces_[number].pieces()) {
      const std::vector<Vec3d> corners = piece_corners(surfaces_[number], piece);
      for (std::size_t i = 0; i < corners.size(); ++i) {
        add_side(number, corners[i], corners[(i + 1) % corners.size()], found);
      }
    }
    return found;
  }

 private:
  void add_side(std::uint32_t number,
                const Vec3d& from,
                const Vec3d& to,
                std::vector<Wedge>& found) const {
    const double length = norm(to - from);
    if (length < kShortest * tolerance_) {
      return;
    }
    const std::vector<std::uint32_t> beside = surfaces_along(from, to);
    std::optional<Wedge> open;  // continues the previous piece
    const std::vector<double> cuts = cuts_of(from, to, beside);
    for (std::size_t i = 1; i < cuts.size(); ++i) {
      const auto at = [&](double share) { return from + share * (to - from); };
      std::optional<Wedge> wedge =
          wedge_at(at(0.5 * (cuts[i - 1] + cuts[i])), (1.0 / length) * (to - from), beside);
      if (!wedge || number != std::min(wedge->face_0, wedge->face_n)) {
        close(open, found);
        continue;
      }
      wedge->from = at(cuts[i - 1]);
      wedge->to = at(cuts[i]);
      if (open && open->face_0 == wedge->face_0 && open->face_n == wedge->face_n) {
        open->to = wedge->to;
      } else {
        close(open, found);
        open = wedge;
      }
    }
    close(open, found);
  }

  static void close(std::optional<Wedge>& open, std::vector<Wedge>& found) {
    if (open) {
      found.push_back(*std::exchange(open, std::nullopt));
    }
  }

  // The surfaces whose plane contains the edge and whose boxes it meets.
  std::vector<std::uint32_t> surfaces_along(const Vec3d& from, const Vec3d& to) const {
    Bounds box;
    box.include(from);
    box.include(to);
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < surfaces_.size(); ++i) {
      if (!apart(boxes_[i], box, tolerance_) &&
          std::abs(distance(surfaces_[i].plane(), from)) <= tolerance_ &&
          std::abs(distance(surfaces_[i].plane(), to)) <= tolerance_) {
        found.push_back(i);
      }
    }
    return found;
  }

  // The shares of the edge between which the surfaces beside it are constant, including 0 and 1.
  std::vector<double> cuts_of(const Vec3d& from,
                              const Vec3d& to,
                              const std::vector<std::uint32_t>& beside) const {
    std::vector<double> all;
    for (const std::uint32_t i : beside) {
      add_cuts(surfaces_[i], from, to, all);
    }
    std::sort(all.begin(), all.end());
    const double least = kShortest * tolerance_ / norm(to - from);
    std::vector<double> cuts{0.0};
    for (const double cut : all) {
      if (cut > cuts.back() + least && cut < 1.0 - least) {
        cuts.push_back(cut);
      }
    }
    cuts.push_back(1.0);
    return cuts;
  }

  // Adds the points where the edge enters and leaves the pieces of a surface in its plane.
  void add_cuts(const Surface& surface,
                const Vec3d& from,
                const Vec3d& to,
                std::vector<double>& cuts) const {
    for (const Surface::Piece& piece : surface.pieces()) {
      double first = 0.0;
      double last = 1.0;
      for (const Surface::Edge& edge : surface.edges(piece)) {
        const auto inside = [&](const Vec3d& p) {
          const Vec3d off = p - surface.origin();
          return edge.a * dot(surface.u_axis(), off) + edge.b * dot(surface.v_axis(), off) +
                 edge.c + tolerance_;
        };
        const double here = inside(from);
        const double there = inside(to);
        if (here < 0.0 && there < 0.0) {
          last = -1.0;
        } else if (here < 0.0) {
          first = std::max(first, here / (here - there));
        } else if (there < 0.0) {
          last = std::min(last, here / (here - there));
        }
      }
      if (first < last) {
        cuts.insert(cuts.end(), {first, last});
      }
    }
  }

  std::optional<Wedge> wedge_at(const Vec3d& point,
                                const Vec3d& along,
                                const std::vector<std::uint32_t>& beside) const {
    const std::vector<HalfPlane> around = half_planes(point, along, beside);
    for (std::size_t i = 0; i < around.size(); ++i) {
      const HalfPlane& first = around[i];
      const HalfPlane& next = around[(i + 1) % around.size()];
      double sector = next.azimuth - first.azimuth;
      if (i + 1 == around.size()) {
        sector += 2.0 * std::numbers::pi;
      }
      if (sector > std::numbers::pi + kFlat) {
        Wedge wedge;
        wedge.along = along;
        wedge.in_face = first.direction;
        wedge.normal = cross(along, first.direction);
        wedge.n = sector / std::numbers::pi;
        wedge.face_0 = first.surface;
        wedge.face_n = next.surface;
        return wedge;
      }
    }
    return std::nullopt;
  }

  // By azimuth; for coincident ones that of the lowest number.
  std::vector<HalfPlane> half_planes(const Vec3d& point,
                                     const Vec3d& along,
                                     const std::vector<std::uint32_t>& beside) const {
    std::vector<HalfPlane> around;
    Vec3d zero;
    for (const std::uint32_t i : beside) {
      const Vec3d across = cross(surfaces_[i].plane().normal, along);
      for (const double side : {1.0, -1.0}) {
        const Vec3d direction = (side / norm(across)) * across;
        if (!surfaces_[i].contains(point + (kBeside * tolerance_) * direction)) {
          continue;
        }
        if (around.empty()) {
          zero = direction;
        }
        double azimuth = std::atan2(dot(cross(zero, direction), along), dot(zero, direction));
        azimuth += azimuth < -kFlat / 2.0 ? 2.0 * std::numbers::pi : 0.0;
        const bool repeated = std::any_of(around.begin(), around.end(), [&](const HalfPlane& h) {
          return dot(h.direction, direction) > std::cos(kFlat);
        });
        if (!repeated) {
          around.push_back({azimuth, direction, i});
        }
      }
    }
    std::sort(around.begin(), around.end(), [](const HalfPlane& a, const HalfPlane& b) {
      return a.azimuth < b.azimuth;
    });
    return around;
  }

  const std::vector<Surface>& surfaces_;
  double tolerance_ = kCoplanarTolerance;
  std::vector<Bounds> boxes_;
};

}  // namespace

std::vector<Wedge> find_wedges(const Scene& scene) {
  const WedgeFinder finder(scene);
  std::vector<std::vector<Wedge>> of_surface(scene.surfaces().size());
  // Surfaces per task: so many sides take about a millisecond.
  constexpr std::size_t kGrain = 16;
  parallel_for(of_surface.size(), kGrain, [&](std::size_t i) {
    of_surface[i] = finder.of(static_cast<std::uint32_t>(i));
  });
  std::vector<Wedge> wedges;
  for (std::vector<Wedge>& some : of_surface) {
    std::move(some.begin(), some.end(), std::back_inserter(wedges));
  }
  return wedges;
}

}  // namespace rayloc
