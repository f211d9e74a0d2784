// Meshes from the bytes of PLY and OBJ files. Vertices are kept as written: same order, not merged,
// in double precision; faces of any shape are cut into triangles (triangulate.h).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"
#include "engine/scene/mesh.h"
#include "engine/scene/scene_note.h"

namespace rayloc {

// Format by the end of the name (".ply", ".OBJ"). Errors begin with the name and state the place: a
// line of text, a byte of a binary file, the number of a face. `notes`: omissions in a usable mesh,
// of the kinds mesh_count and mesh_materials; their messages begin with the name too.
Expected<Mesh> read_mesh(std::string_view bytes,
                         const std::string& name,
                         std::vector<SceneNote>& notes);

// PLY 1.0: ascii, binary_little_endian, binary_big_endian; element "vertex" with x, y, z of any
// type, element "face" with a list "vertex_indices" or "vertex_index", element "tristrips" of such
// lists; all other elements are skipped. A count of the header that does not fit the body is an
// error, or a note where the last element has more entries.
Expected<Mesh> read_ply(std::string_view bytes,
                        const std::string& name,
                        std::vector<SceneNote>& notes);

// The header and the counts of a PLY file alone, for a caller that reads the mesh by other means:
// errors and notes as those of read_ply. Other faults of the body are left to that reader.
Expected<void> check_ply(std::string_view bytes,
                         const std::string& name,
                         std::vector<SceneNote>& notes);

// Wavefront OBJ: v and f. Names, materials, normals, lines and points are skipped; unknown
// statements and curved surfaces are errors.
Expected<Mesh> read_obj(std::string_view bytes,
                        const std::string& name,
                        std::vector<SceneNote>& notes);

}  // namespace rayloc
