#include "engine/grid/grid.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/grid/cell_mass.h"
#include "engine/grid/cell_window.h"
#include "engine/grid/lattice.h"

namespace rayloc::grid_test {
namespace {

TEST(Grid, CoversTheRoomEvenly) {
  const Grid g({0.0, 0.0, 0.0}, {1.0, 0.32, 2.0}, 1.2, 0.1);
  EXPECT_EQ(g.count_x, 10U);
  EXPECT_EQ(g.count_y, 4U);
  EXPECT_NEAR(g.centre(0).y, 0.04, 1e-12);
  EXPECT_NEAR(g.centre(g.size() - 1).x, 0.95, 1e-12);
  EXPECT_NEAR(g.centre(g.size() - 1).y, 0.28, 1e-12);
}

TEST(Grid, FindsTheCellOfAPosition) {
  const Grid g({0.0, 0.0, 0.0}, {1.0, 0.32, 2.0}, 1.2, 0.1);
  for (std::size_t cell = 0; cell < g.size(); ++cell) {
    const Vec3d c = g.centre(cell);
    EXPECT_EQ(g.cell_at(c.x, c.y), cell);
    EXPECT_EQ(g.cell_at(c.x - 0.049, c.y + 0.039), cell);
  }
  EXPECT_EQ(g.cell_at(-0.001, 0.1), g.size());
  EXPECT_EQ(g.cell_at(1.001, 0.1), g.size());
  EXPECT_EQ(g.cell_at(0.5, -0.001), g.size());
  EXPECT_EQ(g.cell_at(0.5, 0.321), g.size());
  EXPECT_EQ(g.cell_at(std::nan(""), 0.1), g.size());
}

TEST(Grid, HasOneLayerByDefault) {
  const Grid g({0.0, 0.0, 0.0}, {1.0, 1.0, 2.0}, 1.2, 0.5);
  EXPECT_TRUE(g.layers.is_known());
  EXPECT_EQ(g.layers.size(), 1U);
}

TEST(CellWindow, NumbersTheCellsOfARectangle) {
  const Grid g({0.0, 0.0, 0.0}, {1.0, 0.5, 2.0}, 1.2, 0.1);
  const CellWindow window{3, 1, 4, 2};
  const Grid part = window.grid_of(g);
  ASSERT_EQ(window.size(), 8U);
  EXPECT_EQ(part.size(), window.size());
  for (std::size_t number = 0; number < window.size(); ++number) {
    const std::size_t cell = window.cell(number, g);
    EXPECT_EQ(window.number(cell, g), number);
    EXPECT_NEAR(part.centre(number).x, g.centre(cell).x, 1e-12);
    EXPECT_NEAR(part.centre(number).y, g.centre(cell).y, 1e-12);
  }
  EXPECT_FALSE(window.number(0, g));
  EXPECT_FALSE(window.number(g.size() - 1, g));
  EXPECT_FALSE(window.is_all_of(g));
  EXPECT_TRUE(CellWindow::all_of(g).is_all_of(g));
}

TEST(CellWindow, KeepsARangeWithoutItsEnds) {
  using Range = std::array<std::size_t, 2>;
  EXPECT_EQ(kept_range({0.0, 0.1, 0.5, 0.3, 0.1, 0.05}, 0.1), (Range{2, 5}));
  EXPECT_EQ(kept_range({0.2, 0.5, 0.3}, 0.1), (Range{0, 3}));
  EXPECT_EQ(kept_range({0.2, 0.5, 0.3}, 2.0), (Range{2, 3}));  // one entry remains
}

TEST(Lattice, IsCentred) {
  const Lattice lattice{5, 3, 0.1, 0.2};
  EXPECT_EQ(lattice.size(), 15U);
  EXPECT_NEAR(lattice.offset(0, 0).x, -0.2, 1e-12);
  EXPECT_NEAR(lattice.offset(4, 2).y, 0.2, 1e-12);
  EXPECT_NEAR(norm(lattice.offset(2, 1)), 0.0, 1e-12);
}

TEST(CellMoments, AreThoseOfAUniformCell) {
  Grid g({0.0, 0.0, 0.0}, {1.0, 1.0, 2.0}, 1.2, 0.1);
  g.height_sigma = 0.3;
  const CellMoments m = uniform_moments(g);
  EXPECT_NEAR(m.xx, 0.01 / 12.0, 1e-12);
  EXPECT_NEAR(m.yy, 0.01 / 12.0, 1e-12);
  EXPECT_NEAR(m.zz, 0.09, 1e-12);
  EXPECT_EQ(m.xy, 0.0);
}

}  // namespace
}  // namespace rayloc::grid_test
