// append_triangles: cuts a face of any shape into triangles.
//
// A face as in PLY and OBJ files: the corners of its outline, of either winding. It need not be
// convex; corners may lie on a straight line; a hole (a doorway in a wall) is part of the outline,
// joined to it by an edge that is traversed in both directions.
//
// References: G. H. Meisters, Amer. Math. Monthly 82 (1975) 648.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/expected.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// A face with more corners is refused: the time of cutting grows with their square, and hand-drawn
// faces have fewer.
inline constexpr std::size_t kMaxCorners = 4096;

// Appends the triangles of the face with the outline `corners`, indices into mesh.vertices; they
// have the winding of the face. A face without area gives triangles without area, which the scene
// counts. An Error (the fault of the face and the remedy; the caller adds which face it is) when
// edges cross or a part of the face lies over another: then the face is ambiguous. REQUIRES: valid
// indices of finite vertices.
Expected<void> append_triangles(std::span<const std::uint32_t> corners, Mesh& mesh);

}  // namespace rayloc
