#include "engine/trace/diffraction/lit_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/scene/bounds.h"

namespace rayloc {
namespace {

// An end nearer to the line of an edge is on it [m]: no path bends there.
constexpr double kOnEdge = 1e-6;

// An edge nearer to a plane is in it, twice the tolerance of meshes [m].
constexpr double kInMirror = 2e-5;

int most_mirrors(const TraceOptions& options) {
  return std::min(kMaxBesideEdge, options.max_depth - 1);
}

}  // namespace

// Collects the edges that one end lights.
class LitEdges::Search {
 public:
  Search(const TraceContext& context, const ImageTree& tree, std::size_t root)
      : wedges_(context.wedges), surfaces_(context.scene->surfaces()), tree_(tree), root_(root) {
    segments_.reserve(wedges_.size());
    lengths_.reserve(wedges_.size());
    face_n_.reserve(wedges_.size());
    for (const Wedge& wedge : wedges_) {
      segments_.push_back(tree.beams().segment(wedge.from, wedge.to));
      lengths_.push_back(norm(wedge.to - wedge.from));
      const double sector = wedge.n * std::numbers::pi;
      face_n_.emplace_back(std::cos(sector), std::sin(sector));
    }
    for (std::size_t first = 0; first < wedges_.size(); first += kTogether) {
      Bounds box;
      for (std::size_t i = first; i < std::min(first + kTogether, wedges_.size()); ++i) {
        box.include(wedges_[i].from);
        box.include(wedges_[i].to);
      }
      boxes_.push_back(tree.beams().box(box.lower, box.upper));
    }
  }

  void add_direct() {
    for (std::uint32_t edge = 0; edge < wedges_.size(); ++edge) {
      add(edge, {kRootNode, 0, {}, 0.0, lengths_[edge]}, tree_.roots()[root_]);
    }
  }

  void add_over(std::uint32_t node, std::uint32_t mirrors) {
    const BeamIndex& beams = tree_.beams();
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      if (!beams.meets(node, boxes_[i])) {
        continue;
      }
      const std::size_t end = std::min((i + 1) * kTogether, wedges_.size());
      for (std::size_t edge = i * kTogether; edge < end; ++edge) {
        SharesOfSegment part;
        if (beams.meets(node, segments_[edge], part) && !is_in_mirror(wedges_[edge], node)) {
          const double length = lengths_[edge];
          add(static_cast<std::uint32_t>(edge),
              {node, mirrors, {}, part.first * length, part.last * length},
              tree_.image(root_, node));
        }
      }
    }
  }

  // By edge, in the order in which they were found.
  void sort_into(std::vector<LitEdge>& lit, std::vector<std::size_t>& first) const {
    first.assign(wedges_.size() + 1, 0);
    for (const std::uint32_t edge : edge_of_) {
      ++first[edge + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    lit.resize(found_.size());
    for (std::size_t i = 0; i < found_.size(); ++i) {
      lit[next[edge_of_[i]]++] = found_[i];
    }
  }

 private:
  // Edges whose common box is tested first: those of a body are neighbours, chosen.
  static constexpr std::size_t kTogether = 8;

  // Such a mirror does not reflect waves from the edge, for any rounding of the edge's position.
  bool is_in_mirror(const Wedge& wedge, std::uint32_t node) const {
    const Plane<double>& plane = surfaces_[tree_.node(node).surface].plane();
    return std::abs(distance(plane, wedge.from)) < kInMirror &&
           std::abs(distance(plane, wedge.to)) < kInMirror;
  }

  void add(std::uint32_t edge, LitEdge lit, const Vec3d& image) {
    const Wedge& wedge = wedges_[edge];
    const Vec3d off = image - wedge.from;
    const double x = dot(off, wedge.in_face);
    const double y = dot(off, wedge.normal);
    lit.image = {dot(off, wedge.along), std::sqrt(x * x + y * y)};
    const auto& [cosine, sine] = face_n_[edge];
    const bool is_within = y < 0.0 && x * sine - y * cosine < 0.0;  // behind both faces
    if (lit.image.radius >= kOnEdge && (!is_within || wedge.is_free())) {
      found_.push_back(lit);
      edge_of_.push_back(edge);
    }
  }

  const std::vector<Wedge>& wedges_;
  const std::vector<Surface>& surfaces_;
  const ImageTree& tree_;
  std::size_t root_;
  std::vector<BeamIndex::Segment> segments_;
  std::vector<double> lengths_;
  std::vector<std::pair<double, double>> face_n_;  // cosine and sine of the wedge's exterior angle
  std::vector<BeamIndex::Box> boxes_;
  std::vector<LitEdge> found_;
  std::vector<std::uint32_t> edge_of_;
};

LitEdges::LitEdges(const TraceContext& context,
                   std::shared_ptr<const ImageTree> tree,
                   std::size_t root)
    : tree_(std::move(tree)), root_(root) {
  Search search(context, *tree_, root);
  const int most = most_mirrors(context.options);
  if (most >= 0) {
    search.add_direct();
  }
  std::vector<int> mirrors;  // of each node
  mirrors.reserve(tree_->size());
  for (std::uint32_t node = 0; node < tree_->size(); ++node) {
    const std::uint32_t parent = tree_->node(node).parent;
    mirrors.push_back(parent == kRootNode ? 1 : mirrors[parent] + 1);
    if (mirrors.back() > most) {
      break;  // nodes with more mirrors come later
    }
    if ((tree_->node(node).roots >> root & 1U) != 0) {
      search.add_over(node, static_cast<std::uint32_t>(mirrors.back()));
    }
  }
  search.sort_into(lit_, first_);
}

std::shared_ptr<const ImageTree> edge_tree(const TraceContext& context, const Vec3d& end) {
  TraceOptions options = context.options;
  options.max_depth = std::max(0, most_mirrors(options));
  return std::make_shared<const ImageTree>(*context.scene, end, options);
}

}  // namespace rayloc
