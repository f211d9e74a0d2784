// read_model: a 3-D model of another program, by the library assimp.
#pragma once

#include <filesystem>

#include "daemon/site/import/model.h"
#include "daemon/site/import/recognise.h"
#include "engine/base/expected.h"

namespace rayloc {

// Parts are the objects of the file, in its order. Corners at one place are one vertex. Units and
// axes are those of the format (glTF: metres, y up; IFC: the file's), else recognised by the total
// size and by objects named floor or ceiling; each is reported in the remarks. An IFC file is
// checked before assimp reads it (ifc/ifc_check.h); other faults may end the process (README).
Expected<Model> read_model(const std::filesystem::path& file,
                           ModelFormat format,
                           const ModelUnits& units);

}  // namespace rayloc
