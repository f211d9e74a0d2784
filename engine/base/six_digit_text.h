// Short decimal text of numbers for people: "0.25", "1e-07".
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace rayloc {

inline std::string six_digit_text(double value) {
  std::array<char, 32> text{};
  // A count of significant digits: micrometres, and degrees as people round them.
  constexpr int kDigits = 6;
  const auto end = std::to_chars(
      text.data(), text.data() + text.size(), value, std::chars_format::general, kDigits);
  return {text.data(), end.ptr};
}

}  // namespace rayloc
