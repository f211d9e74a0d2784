// Reads flat drawings in SVG (W3C, SVG 1.1), as Inkscape and people write them: paths, lines,
// polylines, rectangles and circles with all their transforms, by layer.
#pragma once

#include <filesystem>

#include "daemon/import/drawing.h"
#include "daemon/import/model.h"
#include "engine/base/expected.h"

namespace rayloc {

// A layer is one of Inkscape by its name; in a file without those, a group by its id or class.
// Names of layers within layers are joined: "ground floor/walls". What is hidden is left out.
//
// How long a unit is: units.metres, else what width and viewBox state, times units.scale. An Error
// where they state nothing, or a drawing that is smaller than a room is: it was drawn for paper, at
// a scale that only a person knows.
Expected<Drawing> read_svg(const std::filesystem::path& file, const ModelUnits& units);

}  // namespace rayloc
