// append_triangles: a face of any shape, cut into triangles.
//
// A face is what PLY and OBJ files hold: the corners of its outline, either way round. It need not
// be convex; corners may lie on a straight line; a hole (a doorway in a wall) is part of the
// outline, joined to it by an edge that is run there and back.
//
// References: G. H. Meisters, Amer. Math. Monthly 82 (1975) 648.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/expected.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// A face of more corners is refused: cutting takes a time that grows with their square, and nobody
// draws one by hand.
inline constexpr std::size_t kMostCorners = 4096;

// Appends the triangles of the face that `corners`, indices into mesh.vertices, goes round; they
// face the way the face does. A face without area gives triangles without area, which the scene
// counts. An Error (what is wrong with the face and what to do; the caller says which it is) when
// edges cross or a part of the face lies over another: then nobody knows what is meant.
// REQUIRES: valid indices of finite vertices.
Expected<void> append_triangles(std::span<const std::uint32_t> corners, Mesh& mesh);

}  // namespace rayloc
