// Of a vector that is filled and emptied again and again: it keeps the memory of the most that it
// has ever held, for ever. Behind a backlog that may be a hundred times what it needs since.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rayloc {

// Empties it. Its memory stays for the next time, except where that is more than four times what it
// held now: a backlog comes once, and is followed by less.
template <typename T>
void clear_without_spare(std::vector<T>& values) {
  constexpr std::size_t kSmallBytes = std::size_t{64} << 10U;  // not worth giving back
  const std::size_t needed = std::max(values.size(), kSmallBytes / sizeof(T));
  if (values.capacity() / 4 > needed) {
    values = std::vector<T>();
  } else {
    values.clear();
  }
}

}  // namespace rayloc
