// Median of a list of numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rayloc {

// For an even count the upper of the two middle values: a value of the list.
// REQUIRES: not empty.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rayloc
