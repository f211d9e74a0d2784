#include "engine/grid/cell_set.h"

#include <gtest/gtest.h>

namespace rayloc::cell_set_test {
namespace {

const Grid kGrid({0.0, 0.0, 0.0}, {1.0, 1.0, 2.0}, 1.2, 0.1);

TEST(CellSet, IsAllCellsByDefault) {
  const CellSet all;
  EXPECT_TRUE(all.is_all());
  EXPECT_EQ(all.size(kGrid), kGrid.size());
  EXPECT_EQ(all.ones(kGrid), kGrid.size());
  EXPECT_EQ(all.cell(7), 7U);
  EXPECT_EQ(all.weights.of(7), 1.0);
}

TEST(CellSet, RepresentsTheRestByASample) {
  const std::vector<std::size_t> cells{3, 4, 9};
  const std::vector<std::size_t> sample{20, 40};
  const CellSet set = CellSet::with_sample(cells, sample, kGrid.size());
  EXPECT_FALSE(set.is_all());
  EXPECT_EQ(set.size(kGrid), 5U);
  EXPECT_EQ(set.ones(kGrid), 3U);
  EXPECT_EQ(set.cell(2), 9U);
  EXPECT_EQ(set.cell(3), 20U);
  double represented = 0.0;
  for (std::size_t n = 0; n < set.size(kGrid); ++n) {
    represented += set.weights.of(n);
  }
  EXPECT_NEAR(represented, 100.0, 1e-9);
}

TEST(CellSet, HasEqualWeightsWithoutASample) {
  const std::vector<std::size_t> cells{3, 4, 9};
  const CellSet set = CellSet::with_sample(cells, {}, kGrid.size());
  EXPECT_EQ(set.size(kGrid), 3U);
  EXPECT_EQ(set.ones(kGrid), 3U);
  EXPECT_EQ(set.weights.of(2), 1.0);
}

}  // namespace
}  // namespace rayloc::cell_set_test
