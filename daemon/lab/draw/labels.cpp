#include "daemon/lab/draw/labels.h"

#include <algorithm>

namespace rayloc::draw {

Labels::Extent Labels::extent(const Text& text) {
  constexpr double kAscent = 0.8;  // share of the size
  constexpr double kDescent = 0.25;
  const double width = text_width(text.text, text.size);
  double left = 0.0;
  if (text.anchor != TextAnchor::kStart) {
    left = text.anchor == TextAnchor::kMiddle ? -0.5 * width : -width;
  }
  const double above = kAscent * text.size;
  const double below = kDescent * text.size;
  if (text.degrees != 0.0) {  // quarter turn anticlockwise: along the page's y
    return {{text.at.x - above, text.at.y - (left + width)}, {text.at.x + below, text.at.y - left}};
  }
  return {{text.at.x + left, text.at.y - above}, {text.at.x + left + width, text.at.y + below}};
}

bool Labels::is_clear(const Extent& extent) const {
  return std::none_of(occupied_.begin(), occupied_.end(), [&](const Extent& other) {
    return extent.lower.x < other.upper.x && other.lower.x < extent.upper.x &&
           extent.lower.y < other.upper.y && other.lower.y < extent.upper.y;
  });
}

void Labels::place(const std::vector<Text>& places) {
  for (const Text& text : places) {
    const Extent wanted = extent(text);
    if (is_clear(wanted)) {
      texts_.push_back(text);
      occupied_.push_back(wanted);
      return;
    }
  }
}

}  // namespace rayloc::draw
