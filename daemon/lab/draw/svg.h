// A Drawing as SVG 1.1: one element per shape, numbers to a hundredth of a pixel, no style sheet.
#pragma once

#include <string>

#include "daemon/site/plan/drawing.h"

namespace rayloc::draw {

std::string to_svg(const Drawing& drawing);
// The <svg> element alone, for embedding in an HTML page.
std::string to_svg_element(const Drawing& drawing);

}  // namespace rayloc::draw
