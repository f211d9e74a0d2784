#include "daemon/site/import/imported_site.h"

#include "daemon/site/scene/room_site.h"

namespace rayloc {

std::map<std::string, std::string> imported_site_files(const ImportedScene& imported,
                                                       const std::string& name,
                                                       std::string_view model) {
  RoomPlan plan;
  plan.name = name;
  plan.lower = imported.bounds.lower;
  plan.upper = imported.bounds.upper;
  plan.carrier = usual_carrier();
  auto files = scene_files(imported.scene);
  files["site.toml"] = room_site(plan, model);
  return files;
}

}  // namespace rayloc
