// imported_site_files: the site around an imported scene, which still lacks its access points.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "daemon/site/import/import_scene.h"

namespace rayloc {

// Content by file name: the files of the scene (scene_files.h) and site.toml with the name, the
// bounds of the scene and the usual carrier. `model`: as for room_site(). Thread safety: a pure
// function.
std::map<std::string, std::string> imported_site_files(const ImportedScene& imported,
                                                       const std::string& name,
                                                       std::string_view model = {});

}  // namespace rayloc
