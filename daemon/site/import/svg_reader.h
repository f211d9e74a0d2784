// Reads flat drawings in SVG (W3C, SVG 1.1), as written by Inkscape and by hand: paths, lines,
// polylines, rectangles and circles with all their transforms, by layer.
#pragma once

#include <filesystem>

#include "daemon/site/import/drawing.h"
#include "daemon/site/import/model.h"
#include "engine/base/expected.h"

namespace rayloc {

// A layer is an Inkscape layer, by its name; in a file without these, a group by its id or class.
// Names of nested layers are joined: "ground floor/walls". Hidden elements are left out.
//
// Length of a unit: units.metres, else as stated by width and viewBox, times
// units.scale. Returns an Error without either, or for a drawing smaller
// than a room: it was drawn for paper, and a person must state the scale.
Expected<Drawing> read_svg(const std::filesystem::path& file, const ModelUnits& units);

}  // namespace rayloc
