// One tree, asked by many threads at once. Threads of the standard library, for ThreadSanitizer
// does not see how TBB keeps its own in step.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include <tbb/global_control.h>

#include "engine/trace/images/image_tree.h"
#include "tests/support/laboratory.h"

namespace rayloc::shared_tree_test {
namespace {

TEST(SharedTree, AnswersManyThreadsAlike) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto scene = test::laboratory();
  const Vec3d root = test::laboratory_access_point().pose.position;
  const TraceOptions options{.max_depth = 2};
  const auto positions = test::laboratory_positions(10);
  constexpr int kRounds = 8;  // asked often, the tree looks closer

  const ImageTree alone(*scene, root, options);
  std::vector<std::vector<SpecularChain>> expected(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    expected[i].resize(alone.chains_to(positions[i], expected[i]));
  }

  const ImageTree shared(*scene, root, options);
  std::vector<int> differences(4, 0);
  std::vector<std::thread> threads;
  threads.reserve(differences.size());
  for (int& different : differences) {
    threads.emplace_back([&] {
      std::vector<SpecularChain> chains;
      for (int round = 0; round < kRounds; ++round) {
        for (std::size_t i = 0; i < positions.size(); ++i) {
          const std::size_t count = shared.chains_to(positions[i], chains);
          bool same = count == expected[i].size();
          for (std::size_t k = 0; same && k < count; ++k) {
            same = chains[k].surfaces == expected[i][k].surfaces &&
                   chains[k].points == expected[i][k].points;
          }
          different += same ? 0 : 1;
        }
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(differences, std::vector<int>(4, 0));
}

}  // namespace
}  // namespace rayloc::shared_tree_test
