#include "daemon/site/plan/drawing.h"

#include <algorithm>

namespace rayloc::draw {

double text_width(const std::string& text, double size) {
  constexpr double kMeanAdvance = 0.6;  // share of the size: DejaVu Sans, lower case
  // Continuation bytes of UTF-8 add no width.
  const auto glyphs = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  });
  return kMeanAdvance * size * static_cast<double>(glyphs);
}

}  // namespace rayloc::draw
