// fixed_text: a number with two decimals, for correlations and positions in messages.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace rayloc {

inline std::string fixed_text(double value) {
  std::array<char, 32> text{};
  constexpr int kDigits = 2;  // number of decimals, chosen: a correlation or centimetres
  const auto end = std::to_chars(
      text.data(), text.data() + text.size(), value, std::chars_format::fixed, kDigits);
  return {text.data(), end.ptr};
}

}  // namespace rayloc
