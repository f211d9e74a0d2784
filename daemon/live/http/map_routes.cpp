#include "daemon/live/http/map_files.h"

namespace rayloc {
namespace {

const char* type_of(std::string_view name) {
  const std::string_view extension = name.substr(name.rfind('.') + 1);
  if (extension == "html") {
    return "text/html; charset=utf-8";
  }
  if (extension == "css") {
    return "text/css; charset=utf-8";
  }
  return extension == "js" ? "text/javascript; charset=utf-8" : "image/svg+xml";
}

}  // namespace

std::map<std::string, HttpRoute> map_routes() {
  std::map<std::string, HttpRoute> routes;
  for (const MapFile& file : map_files()) {
    const std::string name(file.name);
    routes[name == "index.html" ? "/" : "/map/" + name] = {[file] {
      return HttpReply{200, type_of(file.name), std::string(file.content)};
    }};
  }
  return routes;
}

}  // namespace rayloc
