#include "engine/trace/image_tree_builder.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/trace/mirror_grower.h"
#include "engine/trace/mirror_table.h"

namespace rayloc {
namespace {

// Parents that one task takes.
constexpr std::size_t kPortion = 32;

// Appends the portions in their order.
void join(const std::vector<GrownNodes>& portions, GrownTree& tree, LitWindows& windows) {
  std::size_t size = tree.nodes.size();
  for (const GrownNodes& portion : portions) {
    size += portion.nodes.size();
  }
  tree.nodes.reserve(size);
  tree.beams.reserve(size);
  for (const GrownNodes& portion : portions) {
    tree.nodes.insert(tree.nodes.end(), portion.nodes.begin(), portion.nodes.end());
    tree.beams.insert(tree.beams.end(), portion.beams.begin(), portion.beams.end());
    windows.append(portion.windows);
  }
}

}  // namespace

GrownTree grow_image_tree(const Scene& scene, const Vec3d& root, const TraceOptions& options) {
  GrownTree tree;
  const MirrorTable table(scene, root, options);
  LitWindows windows;
  std::size_t first = 0;  // of the newest level
  for (int depth = 0; depth < options.max_depth; ++depth) {
    const std::size_t parents = depth == 0 ? 1 : tree.nodes.size() - first;
    std::vector<GrownNodes> portions((parents + kPortion - 1) / kPortion);
    parallel_for(portions.size(), 1, [&](std::size_t portion) {
      MirrorGrower grower(scene, table, options);
      const std::size_t end = std::min(parents, (portion + 1) * kPortion);
      for (std::size_t i = portion * kPortion; i < end; ++i) {
        MirrorGrower::Parent parent{.image = root};
        if (depth > 0) {
          const ImageNode& node = tree.nodes[first + i];
          parent = {static_cast<std::uint32_t>(first + i),
                    node.image,
                    node.image_distance,
                    node.surface,
                    windows.window(i),
                    windows.crossings[i],
                    depth};
        }
        grower.grow(parent, root, portions[portion]);
      }
    });
    first = tree.nodes.size();
    windows = {};
    join(portions, tree, windows);
  }
  return tree;
}

}  // namespace rayloc
