// Meshes from the bytes of PLY and OBJ files. Vertices are kept as they are written: same order,
// not merged, in double precision; polygons are cut into fans.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/expected.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// Format by the end of the name (".ply", ".obj"). Errors begin with the name and, for PLY, say
// where: a line of the header or of an ASCII file, a byte of a binary one.
Expected<Mesh> read_mesh(std::string_view bytes, const std::string& name);

// PLY 1.0: ascii, binary_little_endian, binary_big_endian; element "vertex" with x, y, z of any
// type, element "face" with a list "vertex_indices" or "vertex_index"; anything else is passed
// over.
Expected<Mesh> read_ply(std::string_view bytes, const std::string& name);

Expected<Mesh> read_obj(std::string_view bytes, const std::string& name);

}  // namespace rayloc
