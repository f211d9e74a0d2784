// A Drawing as PNG, by cairo. Only png.cpp includes cairo.
#pragma once

#include <string>

#include "daemon/draw/drawing.h"
#include "engine/base/expected.h"

namespace rayloc::draw {

// `scale`: pixels of the image for one of the drawing. An Error when the image would be larger than
// cairo or memory allow.
Expected<std::string> to_png(const Drawing& drawing, double scale);

}  // namespace rayloc::draw
