#include "daemon/site/plan/painter_order.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

namespace rayloc::draw {
namespace {

constexpr double kOnPlane = 1e-6;  // [m]

struct Halves {
  Face front;
  Face back;
};

void add_corner(Face& face, const Vec3d& corner, bool outlined) {
  face.corners.push_back(corner);
  face.outlined.push_back(outlined);
}

// Cuts a face that has corners on both sides of the plane; the cut is no outline.
Halves split(const Face& face, const Plane<double>& plane) {
  Halves halves{face, face};
  for (Face* half : {&halves.front, &halves.back}) {
    half->corners.clear();
    half->outlined.clear();
  }
  const std::size_t n = face.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d& p = face.corners[i];
    const Vec3d& q = face.corners[(i + 1) % n];
    const double dp = distance(plane, p);
    const double dq = distance(plane, q);
    const bool outlined = face.outlined[i];
    const bool crosses = (dp > 0.0) != (dq > 0.0);
    add_corner(dp > 0.0 ? halves.front : halves.back, p, outlined);
    if (crosses) {
      const Vec3d cut = p + (dp / (dp - dq)) * (q - p);
      // The half that the edge leaves goes on along the cut, the other along the edge.
      add_corner(dp > 0.0 ? halves.front : halves.back, cut, false);
      add_corner(dp > 0.0 ? halves.back : halves.front, cut, outlined);
    }
  }
  return halves;
}

enum class PlaneSide : std::uint8_t { kWithin, kFront, kBack, kBoth };

PlaneSide side_of(const Face& face, const Plane<double>& plane) {
  bool front = false;
  bool back = false;
  for (const Vec3d& corner : face.corners) {
    const double d = distance(plane, corner);
    front = front || d > kOnPlane;
    back = back || d < -kOnPlane;
  }
  if (front && back) {
    return PlaneSide::kBoth;
  }
  return front ? PlaneSide::kFront : (back ? PlaneSide::kBack : PlaneSide::kWithin);
}

Plane<double> plane_of(const Face& face) {
  return {face.normal, dot(face.normal, face.corners[0])};
}

class Partition {
 public:
  explicit Partition(const Vec3d& towards_viewer) : towards_viewer_(towards_viewer) {}

  void paint(std::vector<Face> faces) {
    if (faces.empty()) {
      return;
    }
    const Plane<double> plane = choose_plane(faces);
    std::vector<Face> front;
    std::vector<Face> back;
    std::vector<Face> within;
    for (Face& face : faces) {
      switch (side_of(face, plane)) {
        case PlaneSide::kWithin:
          within.push_back(std::move(face));
          break;
        case PlaneSide::kFront:
          front.push_back(std::move(face));
          break;
        case PlaneSide::kBack:
          back.push_back(std::move(face));
          break;
        case PlaneSide::kBoth:
          Halves halves = split(face, plane);
          front.push_back(std::move(halves.front));
          back.push_back(std::move(halves.back));
      }
    }
    faces.clear();
    if (dot(plane.normal, towards_viewer_) <= 0.0) {
      front.swap(back);
    }
    paint(std::move(back));
    std::move(within.begin(), within.end(), std::back_inserter(order));
    paint(std::move(front));
  }

  std::vector<Face> order;

 private:
  // Chooses the face whose plane splits the fewest
  // others: fewer faces, and no seams through walls.
  Plane<double> choose_plane(const std::vector<Face>& faces) {
    constexpr std::size_t kCandidates = 24;
    Plane<double> best = plane_of(faces[0]);
    std::ptrdiff_t fewest = std::numeric_limits<std::ptrdiff_t>::max();
    for (std::size_t i = 0; i < std::min(kCandidates, faces.size()) && fewest > 0; ++i) {
      const std::size_t chosen = faces.size() <= kCandidates ? i : next() % faces.size();
      const Plane<double> plane = plane_of(faces[chosen]);
      const auto splits = std::count_if(faces.begin(), faces.end(), [&](const Face& face) {
        return side_of(face, plane) == PlaneSide::kBoth;
      });
      if (splits < fewest) {
        fewest = splits;
        best = plane;
      }
    }
    return best;
  }

  // A fixed sequence, so that a picture is always the same (Knuth's MMIX generator).
  std::size_t next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>(state_ >> 33U);
  }

  Vec3d towards_viewer_;
  std::uint64_t state_ = 1;
};

double nearness(const Face& face, const Vec3d& towards_viewer) {
  double sum = 0.0;
  for (const Vec3d& corner : face.corners) {
    sum += dot(corner, towards_viewer);
  }
  return sum / static_cast<double>(face.corners.size());
}

}  // namespace

std::vector<Face> painter_order(std::vector<Face> faces, const Vec3d& towards_viewer) {
  if (faces.size() > kMaxSplit) {
    std::stable_sort(faces.begin(), faces.end(), [&](const Face& a, const Face& b) {
      return nearness(a, towards_viewer) < nearness(b, towards_viewer);
    });
    return faces;
  }
  Partition partition(towards_viewer);
  partition.paint(std::move(faces));
  return std::move(partition.order);
}

}  // namespace rayloc::draw
