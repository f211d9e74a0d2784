// The two views of a room, as draw_scene places them on the page. Internal to scene_picture.
#pragma once

#include <vector>

#include "daemon/lab/draw/labels.h"
#include "daemon/site/plan/drawing.h"
#include "daemon/site/plan/projection.h"
#include "daemon/site/plan/scene_parts.h"
#include "engine/scene/scene.h"

namespace rayloc::draw {

// plan_view.cpp
std::vector<Shape> draw_plan(const Scene& scene,
                             const std::vector<ScenePart>& parts,
                             const Projection& page);
void label_plan(const std::vector<ScenePart>& parts,
                const Bounds& all,
                const Projection& page,
                Labels& labels);
// Metres along two sides; the areas of the numbers are reserved in `labels`.
std::vector<Shape> draw_ruler(const Bounds& all, const Projection& page, Labels& labels);

// isometric_view.cpp
std::vector<Shape> draw_isometric(const Scene& scene,
                                  const std::vector<ScenePart>& parts,
                                  const Projection& page);
void label_isometric(const std::vector<ScenePart>& parts, const Projection& page, Labels& labels);
std::vector<Shape> draw_axes(const PagePoint& corner);

}  // namespace rayloc::draw
