// Reads flat drawings of the Drawing Exchange Format (DXF, as text; Autodesk's DXF Reference for
// R12 to 2018): LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE and the blocks that contain them,
// by layer. Curves become chords. Hidden parts are left out and counted, as are other entities.
#pragma once

#include <filesystem>

#include "daemon/site/import/drawing.h"
#include "engine/base/expected.h"

namespace rayloc {

// Returns an Error with file name and line if the file is no DXF or contains no line.
Expected<Drawing> read_dxf(const std::filesystem::path& file);

}  // namespace rayloc
