// drawn_plan: converts a flat drawing of a storey to a model, with its walls extruded to a height.
#pragma once

#include "daemon/site/import/drawing.h"
#include "daemon/site/import/material_table.h"
#include "daemon/site/import/model.h"
#include "engine/base/expected.h"

namespace rayloc {

struct DrawnPlanOptions {
  double metres = 0.0;  // per unit; 0: as the drawing states it, else recognised
  double height = 0.0;  // [m], floor to ceiling; 0: kUsualHeight
};
inline constexpr double kUsualHeight = 2.7;  // [m], in offices

// MaterialTable::layer gives the kind of each layer. Two parallel lines of
// walls, 4 to 50 cm apart, are the faces of one wall and become a sheet between
// them, of that thickness; a line alone is a wall of the thickness of its
// material. Lines of windows become panes between kSill and kHead, with wall
// above and below; gaps with doors are left open. Closed lines of furniture are
// tops at kTop. Floor and ceiling are the rectangle around the walls. Its lower
// left corner is the origin. Returns an Error if no layer is one of walls, with
// the names of the layers, or if an outline of walls crosses itself. REQUIRES: a line.
inline constexpr double kSill = 0.9;  // [m], windows in offices
inline constexpr double kHead = 2.1;  // [m]
inline constexpr double kTop = 0.75;  // [m], tables
Expected<Model> drawn_plan(const Drawing& drawing,
                           const MaterialTable& table,
                           const DrawnPlanOptions& options);

}  // namespace rayloc
