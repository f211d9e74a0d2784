#include "engine/posterior/cell_places.h"

#include <gtest/gtest.h>

#include <array>

namespace rayloc::cell_places_test {
namespace {

TEST(CellPlaces, TheRestAndTheBestPlaceAreAllOfTheMass) {
  const CellMoments best{0.01, -0.005, 1e-5, 2e-6, 2e-5, 0.1, 1e-6, -2e-6, 4e-4};
  const CellMoments rest{-0.008, 0.012, 2e-4, -3e-5, 1e-4, -0.2, 3e-5, 1e-5, 2e-2};
  const std::array<WeightedMoments, 2> parts{{{0.3, best}, {0.7, rest}}};
  const CellMoments found = rest_of({mixture_of(parts), best, 0.3, {}});
  EXPECT_NEAR(found.x, rest.x, 1e-12);
  EXPECT_NEAR(found.y, rest.y, 1e-12);
  EXPECT_NEAR(found.z, rest.z, 1e-12);
  EXPECT_NEAR(found.xx, rest.xx, 1e-12);
  EXPECT_NEAR(found.xy, rest.xy, 1e-12);
  EXPECT_NEAR(found.yy, rest.yy, 1e-12);
  EXPECT_NEAR(found.xz, rest.xz, 1e-12);
  EXPECT_NEAR(found.yz, rest.yz, 1e-12);
  EXPECT_NEAR(found.zz, rest.zz, 1e-12);
}

TEST(CellPlaces, WithoutARestItIsAllOfTheMass) {
  const CellMoments all{0.01, -0.005, 1e-5, 2e-6, 2e-5};
  EXPECT_EQ(rest_of({all, all, 1.0, {}}).xx, all.xx);
}

}  // namespace
}  // namespace rayloc::cell_places_test
