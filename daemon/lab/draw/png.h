// A Drawing as PNG, by cairo. Only png.cpp includes cairo.
#pragma once

#include <string>

#include "daemon/site/plan/drawing.h"
#include "engine/base/expected.h"

namespace rayloc::draw {

// `scale`: image pixels per drawing pixel. Returns an Error
// if the image would be larger than cairo or memory allow.
Expected<std::string> to_png(const Drawing& drawing, double scale);

}  // namespace rayloc::draw
