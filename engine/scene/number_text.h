// read_number: a number of a mesh that is written as text.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace rayloc {

// The number that the text begins with, cut off from it; nothing when it begins with none. Some
// exporters write "+4.0".
inline std::optional<double> read_number(std::string_view& text) {
  const bool has_plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  double value = 0.0;
  const char* const begin = text.data() + (has_plus ? 1 : 0);
  const auto [end, status] = std::from_chars(begin, text.data() + text.size(), value);
  if (status != std::errc()) {
    return std::nullopt;
  }
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

}  // namespace rayloc
