// A Drawing as the bytes of a file, SVG or PNG according to the file name's ending.
#pragma once

#include <string>

#include "daemon/site/plan/drawing.h"
#include "engine/base/expected.h"

namespace rayloc::draw {

// Returns an Error of kind kUsage for another ending; else as to_png().
Expected<std::string> picture_bytes(const Drawing& drawing, const std::string& file);

}  // namespace rayloc::draw
