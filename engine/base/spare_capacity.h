// Limits the memory of a vector that is filled and emptied repeatedly: a vector keeps the capacity
// of its largest size for ever, which after a backlog may be a hundred times its later need.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rayloc {

// Clears the vector. Its memory is kept for reuse, except where that is more than four times its
// current size: a backlog is rare, and smaller fillings follow it.
template <typename T>
void clear_without_spare(std::vector<T>& values) {
  constexpr std::size_t kSmallBytes = std::size_t{64} << 10U;  // not worth freeing
  const std::size_t needed = std::max(values.size(), kSmallBytes / sizeof(T));
  if (values.capacity() / 4 > needed) {
    values = std::vector<T>();
  } else {
    values.clear();
  }
}

}  // namespace rayloc
