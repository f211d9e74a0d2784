#include "engine/base/spare_capacity.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace rayloc::spare_capacity_test {
namespace {

TEST(ClearWithoutSpare, KeepsTheRecentlyNeededCapacity) {
  std::vector<std::byte> bytes(1'000'000);
  const std::byte* const place = bytes.data();
  clear_without_spare(bytes);
  EXPECT_TRUE(bytes.empty());
  bytes.resize(600'000);
  EXPECT_EQ(bytes.data(), place);
}

TEST(ClearWithoutSpare, ReleasesTheCapacityOfABacklog) {
  std::vector<std::byte> bytes(10'000'000);
  clear_without_spare(bytes);
  bytes.resize(1'000'000);
  clear_without_spare(bytes);
  EXPECT_TRUE(bytes.empty());
  EXPECT_EQ(bytes.capacity(), 0U);
}

TEST(ClearWithoutSpare, KeepsSmallCapacities) {
  std::vector<double> values(4000);
  clear_without_spare(values);
  clear_without_spare(values);
  EXPECT_EQ(values.capacity(), 4000U);
}

}  // namespace
}  // namespace rayloc::spare_capacity_test
