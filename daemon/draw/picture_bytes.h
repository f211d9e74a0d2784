// A Drawing as the bytes of a file, SVG or PNG by the ending of its name.
#pragma once

#include <string>

#include "daemon/draw/drawing.h"
#include "engine/base/expected.h"

namespace rayloc::draw {

// An Error of kUsage for another ending; else as of to_png().
Expected<std::string> picture_bytes(const Drawing& drawing, const std::string& file);

}  // namespace rayloc::draw
