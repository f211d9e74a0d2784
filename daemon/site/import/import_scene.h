// import_scene: converts a drawing or a scan of another program to a scene with radio materials.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/site/import/material_table.h"
#include "daemon/site/import/model.h"
#include "daemon/site/scene/scene_files.h"
#include "engine/base/expected.h"
#include "engine/scene/bounds.h"

namespace rayloc {

struct ImportOptions {
  ModelUnits units;
  double tolerance = 0.0;  // [m], for the planes of a scan; 0: from the scan itself
};

struct ImportedScene {
  StatedScene scene;
  Bounds bounds;
  std::vector<std::string> remarks;  // recognised, assumed and omitted content
};

// The scene of a model: dense parts become planes; each part, or each plane of a scan without
// names, is an object with the material that the table has for it.
Expected<ImportedScene> scene_of(const Model& model,
                                 const MaterialTable& table,
                                 const ImportOptions& options);

Expected<ImportedScene> import_scene(const std::filesystem::path& file,
                                     const MaterialTable& table,
                                     const ImportOptions& options);

}  // namespace rayloc
