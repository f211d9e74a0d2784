#include "engine/localize/box_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace rayloc::box_lattice_test {
namespace {

Grid grid_of(double height_sigma) {
  Grid grid({-1.0, 2.0, 0.0}, {0.55, 3.25, 2.5}, 1.2, 0.05);  // 31 x 25 cells
  grid.height_sigma = height_sigma;
  grid.layers = height_layers({1.2, height_sigma}, 0.0, 2.5);
  return grid;
}

TEST(BoxLattice, HasBlocksOfCellsAndPartsOfTheHeights) {
  const BoxLattice known(grid_of(0.0));
  EXPECT_EQ(known.size(), 16U * 13U);
  EXPECT_NEAR(known.half().x, 0.05, 1e-12);
  EXPECT_EQ(known.half().z, 0.0);
  EXPECT_EQ(known.middle(0).z, 1.2);
  const BoxLattice unknown(grid_of(0.3));  // a range of 1.35 m
  EXPECT_EQ(unknown.size() % (16U * 13U), 0U);
  EXPECT_NEAR(unknown.half().z, 0.15, 0.03);
  Grid coarse({0.0, 0.0, 0.0}, {2.0, 2.0, 2.0}, 1.0, 0.2);
  EXPECT_EQ(BoxLattice(coarse).size(), coarse.size());
}

TEST(BoxLattice, ContainsEveryPlaceOfTheGridOnce) {
  for (const double sigma : {0.0, 0.3}) {
    const BoxLattice lattice(grid_of(sigma));
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform;
    std::set<std::uint32_t> met;
    for (int i = 0; i < 20'000; ++i) {
      const float x = -1.0F + 1.55F * uniform(random);
      const float y = 2.0F + 1.25F * uniform(random);
      const float z = 1.2F + (sigma > 0.0 ? 1.34F * (uniform(random) - 0.5F) : 0.0F);
      const std::uint32_t box = lattice.box_at(x, y, z);
      ASSERT_LT(box, lattice.size());
      met.insert(box);
      const Vec3d middle = lattice.middle(box);
      EXPECT_LE(std::abs(static_cast<double>(x) - middle.x), lattice.half().x + 1e-6);
      EXPECT_LE(std::abs(static_cast<double>(y) - middle.y), lattice.half().y + 1e-6);
      EXPECT_LE(std::abs(static_cast<double>(z) - middle.z), lattice.half().z + 1e-6);
      // The cell of its rays is at most half a cell from its middle.
      const Vec3d centre = lattice.grid().centre(lattice.cell(box));
      EXPECT_LE(std::abs(centre.x - middle.x), 0.5 * lattice.grid().step_x + 1e-9);
      EXPECT_LE(std::abs(centre.y - middle.y), 0.5 * lattice.grid().step_y + 1e-9);
    }
    EXPECT_EQ(met.size(), lattice.size());
  }
}

TEST(BoxLattice, IsTheBoxOfItsMiddle) {
  const BoxLattice lattice(grid_of(0.3));
  for (std::uint32_t box = 0; box < lattice.size(); ++box) {
    const Vec3d middle = lattice.middle(box);
    // A middle between two cells belongs to the upper one of the same box.
    EXPECT_EQ(lattice.box_at(static_cast<float>(middle.x),
                             static_cast<float>(middle.y),
                             static_cast<float>(middle.z)),
              box);
  }
}

TEST(BoxLattice, EndsWithTheGridAndItsHeights) {
  const BoxLattice lattice(grid_of(0.3));
  const auto at = [&](double x, double y, double z) {
    return lattice.box_at(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  };
  EXPECT_NE(at(0.0, 2.5, 1.2), BoxLattice::kNone);
  EXPECT_EQ(at(-1.001, 2.5, 1.2), BoxLattice::kNone);
  EXPECT_EQ(at(0.551, 2.5, 1.2), BoxLattice::kNone);
  EXPECT_EQ(at(0.0, 1.999, 1.2), BoxLattice::kNone);
  EXPECT_EQ(at(0.0, 3.251, 1.2), BoxLattice::kNone);
  EXPECT_EQ(at(0.0, 2.5, 0.5), BoxLattice::kNone);
  EXPECT_EQ(at(0.0, 2.5, 1.9), BoxLattice::kNone);
  EXPECT_EQ(at(1e30, 2.5, 1.2), BoxLattice::kNone);
  EXPECT_EQ(at(std::nan(""), 2.5, 1.2), BoxLattice::kNone);
  EXPECT_EQ(at(5.0, 2.5, 1.2), BoxLattice::kNone);
  EXPECT_EQ(lattice.cell(at(-0.99, 2.01, 1.2)), 0U);
  const BoxLattice known(grid_of(0.0));
  EXPECT_EQ(known.box_at(0.0F, 2.5F, 99.0F), known.box_at(0.0F, 2.5F, 1.2F));
}

}  // namespace
}  // namespace rayloc::box_lattice_test
