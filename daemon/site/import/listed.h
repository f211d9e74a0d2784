// listed: the first of many names, for a message.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

namespace rayloc {

// Names: a container of std::string.
template <typename Names>
std::string listed(const Names& names) {
  constexpr std::size_t kMost = 20;  // count, chosen: as many as a person reads
  const std::size_t count = std::min(kMost, names.size());
  const std::vector<std::string> first(
      names.begin(), std::next(names.begin(), static_cast<std::ptrdiff_t>(count)));
  const std::size_t more = names.size() - count;
  return fmt::format(
      "{}{}", fmt::join(first, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace rayloc
