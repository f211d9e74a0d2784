#include "engine/trace/images/image_tree_builder.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/parallel.h"
#include "engine/trace/images/mirror_grower.h"
#include "engine/trace/images/mirror_table.h"
#include "engine/trace/images/shooting.h"

namespace rayloc {
namespace {

// Parents per task.
constexpr std::size_t kPortion = 32;
// In units of one test of a surface against a beam, each about 0.5 ns: the cost of an image, and
// the maximum of an exhaustive tree.
constexpr double kWorkOfImage = 1000.0;
constexpr double kMaxWork = 2e8;  // same unit, chosen: about 0.1 s
// Part of that for a tree of several roots: the separate tree of each root, with about as many
// images, is then exhaustive too, so that both give the same result for a root.
constexpr double kSharedPart = 0.5;

// Appends the portions in order.
void join(const std::vector<GrownNodes>& portions,
          std::size_t roots,
          GrownTree& tree,
          LitWindows& windows) {
  std::size_t size = tree.nodes.size();
  for (const GrownNodes& portion : portions) {
    size += portion.nodes.size();
  }
  tree.nodes.reserve(size);
  tree.beams.reserve(size);
  tree.images.reserve(size * roots);
  for (const GrownNodes& portion : portions) {
    tree.nodes.insert(tree.nodes.end(), portion.nodes.begin(), portion.nodes.end());
    tree.images.insert(tree.images.end(), portion.images.begin(), portion.images.end());
    tree.beams.insert(tree.beams.end(), portion.beams.begin(), portion.beams.end());
    windows.append(portion.windows);
  }
}

// A tree that grows by levels.
class Growth {
 public:
  // trie: nullptr to search exhaustively.
  Growth(const Scene& scene,
         const MirrorTable& table,
         std::span<const Vec3d> roots,
         const TraceOptions& options,
         const MirrorTrie* trie)
      : scene_(scene), table_(table), options_(options), trie_(trie) {
    for (const Vec3d& root : roots) {
      roots_.push_back({root, 0.0});
    }
  }

  bool is_complete() const { return depth_ == options_.max_depth; }

  void add_level() {
    const std::size_t parents = depth_ == 0 ? 1 : tree_.nodes.size() - first_;
    std::vector<GrownNodes> portions((parents + kPortion - 1) / kPortion);
    parallel_for(portions.size(), 1, [&](std::size_t portion) {
      MirrorGrower grower(scene_, table_, options_, trie_);
      const std::size_t end = std::min(parents, (portion + 1) * kPortion);
      for (std::size_t i = portion * kPortion; i < end; ++i) {
        grower.grow(parent(i), portions[portion]);
      }
    });
    work_ += static_cast<double>(parents) * static_cast<double>(scene_.surfaces().size());
    first_ = tree_.nodes.size();
    windows_ = {};
    join(portions, roots_.size(), tree_, windows_);
    const std::size_t added = tree_.nodes.size() - first_;
    work_ += kWorkOfImage * static_cast<double>(added);
    growth_ = static_cast<double>(added) / static_cast<double>(parents);
    ++depth_;
  }

  // Work of an exhaustive search including the next level, if that grows as the last one did.
  double work_with_next_level() const {
    const auto parents = static_cast<double>(depth_ == 0 ? 1 : tree_.nodes.size() - first_);
    return work_ +
           parents * (static_cast<double>(scene_.surfaces().size()) + kWorkOfImage * growth_);
  }

  GrownTree take() && { return std::move(tree_); }

 private:
  // Node `i` of the newest level.
  MirrorGrower::Parent parent(std::size_t i) const {
    if (depth_ == 0) {
      const auto all = static_cast<RootSet>((std::uint64_t{1} << roots_.size()) - 1);
      return {.images = roots_, .roots = all};
    }
    const ImageNode& node = tree_.nodes[first_ + i];
    return {static_cast<std::uint32_t>(first_ + i),
            std::span(tree_.images).subspan((first_ + i) * roots_.size(), roots_.size()),
            node.roots,
            node.surface,
            windows_.window(i),
            windows_.crossings[i],
            depth_,
            trie_ == nullptr ? MirrorGrower::kNoTrieNode : windows_.trie_nodes[i]};
  }

  const Scene& scene_;
  const MirrorTable& table_;
  std::vector<Image> roots_;
  const TraceOptions& options_;
  const MirrorTrie* trie_;
  GrownTree tree_;
  LitWindows windows_;     // of the newest level
  std::size_t first_ = 0;  // its first node
  int depth_ = 0;
  double work_ = 0.0;
  double growth_ = 0.0;  // ratio of images between the newest level and the previous one
};

GrownTree grow_from_rays(const Scene& scene, const Vec3d& root, const TraceOptions& options) {
  const ShotMirrors shot = shoot_mirrors(scene, root, options);
  std::vector<std::uint32_t> objects;
  for (const std::uint32_t surface : shot.trie.surfaces()) {
    objects.push_back(scene.owner(surface).object);
  }
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  const std::span<const Vec3d> roots(&root, 1);
  const MirrorTable table(scene, roots, options, objects);
  Growth growth(scene, table, roots, options, &shot.trie);
  while (!growth.is_complete()) {
    growth.add_level();
  }
  GrownTree tree = std::move(growth).take();
  tree.generator = CandidateGenerator::kShooting;
  return tree;
}

}  // namespace

std::optional<GrownTree> grow_exhaustively(const Scene& scene,
                                           std::span<const Vec3d> roots,
                                           const TraceOptions& options) {
  RAYLOC_CHECK(options.max_depth >= 0 && !roots.empty() && roots.size() <= kMaxRoots);
  if (options.candidates == CandidateGenerator::kShooting) {
    return std::nullopt;
  }
  double most_work = roots.size() == 1 ? kMaxWork : kSharedPart * kMaxWork;
  if (options.candidates == CandidateGenerator::kExhaustive) {
    most_work = std::numeric_limits<double>::infinity();
  }
  const MirrorTable table(scene, roots, options);
  Growth growth(scene, table, roots, options, nullptr);
  while (!growth.is_complete()) {
    if (growth.work_with_next_level() > most_work) {
      return std::nullopt;
    }
    growth.add_level();
  }
  return std::move(growth).take();
}

GrownTree grow_image_tree(const Scene& scene, const Vec3d& root, const TraceOptions& options) {
  RAYLOC_CHECK(options.rays > 0);
  if (auto tree = grow_exhaustively(scene, std::span(&root, 1), options)) {
    return std::move(*tree);
  }
  return grow_from_rays(scene, root, options);
}

}  // namespace rayloc
