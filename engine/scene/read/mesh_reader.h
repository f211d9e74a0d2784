// Meshes from the bytes of PLY and OBJ files. Vertices are kept as they are written: same order,
// not merged, in double precision; faces of any shape are cut into triangles (triangulate.h).
#pragma once

#include <string>
#include <string_view>

#include "engine/base/expected.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// Format by the end of the name (".ply", ".OBJ"). Errors begin with the name and say where: a line
// of text, a byte of a binary file, the number of a face.
Expected<Mesh> read_mesh(std::string_view bytes, const std::string& name);

// PLY 1.0: ascii, binary_little_endian, binary_big_endian; element "vertex" with x, y, z of any
// type, element "face" with a list "vertex_indices" or "vertex_index", element "tristrips" of such
// lists; anything else is passed over.
Expected<Mesh> read_ply(std::string_view bytes, const std::string& name);

// Wavefront OBJ: v and f. Names, materials, normals, lines and points are passed over; what an OBJ
// file does not have, and curved surfaces, are errors.

Expected<Mesh> read_obj(std::string_view bytes, const std::string& name);

}  // namespace rayloc
