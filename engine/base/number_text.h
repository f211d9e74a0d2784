// read_number: parses a number from the text of a file.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace rayloc {

// The number at the beginning of the text, which is removed from it; nothing when it begins with
// none. Some exporters write "+4.0".
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

// Precision of a file's coordinates, from the largest number of digits that it writes. Many
// programs write six of them, regardless of the decimal point: 12.3457 is exact to 0.05 mm.
class TextPrecision {
 public:
  void note(std::string_view number, double value) {
    const std::string_view digits = number.substr(0, number.find_first_of("eE"));
    const std::size_t first = digits.find_first_of("123456789");
    if (first != std::string_view::npos) {
      digits_ = std::max(digits_,
                         std::count_if(digits.begin() + static_cast<std::ptrdiff_t>(first),
                                       digits.end(),
                                       [](char c) { return c >= '0' && c <= '9'; }));
    }
    largest_ = std::max(largest_, std::abs(value));
  }

  // Mesh::rounding [m]. Numbers of fewer digits are round ones, as people write them, and so may be
  // numbers whose last digit is a millimetre: the result is no coarser than this.
  double rounding() const {
    constexpr std::ptrdiff_t kFewest = 6;  // a count of digits, chosen: people write fewer
    constexpr double kCoarsest = 5e-5;     // [m], chosen: half of a tenth of a millimetre
    if (digits_ < kFewest || !(largest_ > 0.0)) {
      return 0.0;
    }
    const double before_point = std::floor(std::log10(largest_)) + 1.0;
    return std::min(kCoarsest, 0.5 * std::pow(10.0, before_point - static_cast<double>(digits_)));
  }

 private:
  std::ptrdiff_t digits_ = 0;
  double largest_ = 0.0;
};

}  // namespace rayloc
