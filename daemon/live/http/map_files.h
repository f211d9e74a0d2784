// The live map: the files of map/, which are part of the program, and their paths.
//
//   /               index.html
//   /map/NAME       the others
//
// They load no external resources: every answer carries a policy that limits the requests of a
// browser (request_handler.cpp).
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/live/http/http_server.h"

namespace rayloc {

struct MapFile {
  std::string_view name;
  std::string_view content;
};

// Written by the build (cmake/EmbedFiles.cmake).
const std::vector<MapFile>& map_files();

std::map<std::string, HttpRoute> map_routes();

}  // namespace rayloc
