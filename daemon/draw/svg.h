// A Drawing as SVG 1.1: one element a shape, numbers to a hundredth of a pixel, no style sheet.
#pragma once

#include <string>

#include "daemon/draw/drawing.h"

namespace rayloc::draw {

std::string to_svg(const Drawing& drawing);
// The <svg> element alone, to stand in a page of HTML.
std::string to_svg_element(const Drawing& drawing);

}  // namespace rayloc::draw
