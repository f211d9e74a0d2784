// The column beside a picture: materials, powers, symbols, and a scale bar.
#pragma once

#include <vector>

#include "daemon/lab/draw/scene_picture.h"
#include "daemon/site/plan/drawing.h"

namespace rayloc::draw {

inline constexpr double kLegendWidth = 170.0;

struct Legend {
  std::vector<Shape> shapes;
  double height = 0.0;
};

// `pixels_per_metre`: for lengths along the axes, as the view shows them.
Legend draw_legend(const ScenePicture& picture,
                   View view,
                   double pixels_per_metre,
                   const PagePoint& corner);

// The symbol of an antenna; also used in the picture.
std::vector<Shape> draw_antenna(const PagePoint& at, MarkKind kind);

}  // namespace rayloc::draw
