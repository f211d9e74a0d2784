// row_of: the row of a table that has a type of IFC as its key.
#pragma once

#include <algorithm>
#include <string_view>

namespace rayloc {

// `rows`: contiguous, each with a `type` ("IFCWALL"). Null: none.
template <typename Rows>
auto row_of(const Rows& rows, std::string_view type) -> decltype(rows.data()) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.type == type; });
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace rayloc
