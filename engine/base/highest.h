// highest: the indices of the highest of many numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace rayloc {

// Indices of the `most` highest numbers, or of all; the highest first, equal ones in order.
inline std::vector<std::size_t> highest(const std::vector<double>& numbers, std::size_t most) {
  std::vector<std::size_t> order(numbers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto kept = static_cast<std::ptrdiff_t>(std::min(most, order.size()));
  std::partial_sort(
      order.begin(), order.begin() + kept, order.end(), [&](std::size_t a, std::size_t b) {
        return numbers[a] > numbers[b] || (numbers[a] == numbers[b] && a < b);
      });
  order.resize(static_cast<std::size_t>(kept));
  return order;
}

}  // namespace rayloc
