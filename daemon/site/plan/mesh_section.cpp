#include "daemon/site/plan/mesh_section.h"

#include <array>
#include <cstddef>
#include <map>
#include <utility>

namespace rayloc::draw {
namespace {

struct Cut {
  Edge edge;
  Vec3d point;
};

Cut cut_edge(Vec3d a, Vec3d b, double z) {
  if (place_of(b) < place_of(a)) {
    std::swap(a, b);  // so that both triangles compute the same point
  }
  return {{place_of(a), place_of(b)}, a + ((z - a.z) / (b.z - a.z)) * (b - a)};
}

// Connects segments that share an edge of the mesh to chains.
class Chainer {
 public:
  void add(const Cut& from, const Cut& to) {
    for (const Cut& end : {from, to}) {
      at_edge_[end.edge].push_back(segments_.size());
    }
    segments_.push_back({from, to});
    used_.push_back(false);
  }

  MeshSection chains() {
    MeshSection section;
    for (const bool only_ends : {true, false}) {
      for (std::size_t i = 0; i < segments_.size(); ++i) {
        for (std::size_t end = 0; end < 2; ++end) {
          const bool is_end = at_edge_[segments_[i].at(end).edge].size() == 1;
          if (!used_[i] && (is_end || !only_ends)) {
            auto& chains = is_end ? section.lines : section.loops;
            chains.push_back(follow(i, end));
            if (!is_end) {
              chains.back().pop_back();  // equal to the first corner
            }
          }
        }
      }
    }
    return section;
  }

 private:
  // Follows the chain from that end of the segment.
  std::vector<Vec3d> follow(std::size_t segment, std::size_t end) {
    std::vector<Vec3d> points{segments_[segment].at(end).point};
    for (bool found = true; found;) {
      used_[segment] = true;
      const Cut& next = segments_[segment].at(1 - end);
      points.push_back(next.point);
      found = false;
      for (const std::size_t candidate : at_edge_[next.edge]) {
        if (!used_[candidate]) {
          segment = candidate;
          end = segments_[candidate][0].edge == next.edge ? 0 : 1;
          found = true;
          break;
        }
      }
    }
    return points;
  }

  std::vector<std::array<Cut, 2>> segments_;
  std::vector<bool> used_;
  std::map<Edge, std::vector<std::size_t>> at_edge_;
};

}  // namespace

MeshSection cut_mesh(const Mesh& mesh, double z) {
  Chainer chainer;
  for (const auto& triangle : mesh.triangles) {
    std::vector<Cut> cuts;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d& a = mesh.vertices[triangle.at(i)];
      const Vec3d& b = mesh.vertices[triangle.at((i + 1) % 3)];
      // A corner in the plane counts as above it: an edge is cut or not, never touched.
      if ((a.z >= z) != (b.z >= z)) {
        cuts.push_back(cut_edge(a, b, z));
      }
    }
    if (cuts.size() == 2) {
      chainer.add(cuts[0], cuts[1]);
    }
  }
  return chainer.chains();
}

}  // namespace rayloc::draw
