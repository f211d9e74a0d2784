// `rayloc scene check|import|map|room|show`: inspects, makes and draws scenes.
#include <array>
#include <utility>
#include <vector>

#include "daemon/cli/verbs/scene/scene_verbs.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

struct Part {
  const char* name;
  const char* summary;
  RunVerb (*declare)(OptionParser& app);
};

constexpr std::array kSceneParts = {
    Part{"check",
         "Summarize a scene or site, and warn of what is probably a mistake",
         declare_scene_check},
    Part{"import", "Make a scene from a drawing or scan of another program", declare_scene_import},
    Part{"map", "Map the path gain of access points over a room", declare_scene_map},
    Part{"room",
         "Make a scene from a few lines of TOML: a room, its walls and furniture",
         declare_scene_room},
    Part{"show", "Draw a scene, its antennas and the paths of a link", declare_scene_show},
};

RunVerb declare_scene_parts(OptionParser& app) {
  app.require_subcommand(1);
  std::vector<std::pair<const OptionParser*, RunVerb>> parts;
  for (const Part& part : kSceneParts) {
    OptionParser* sub = app.add_subcommand(part.name, part.summary);
    RunVerb run = part.declare(*sub);
    parts.emplace_back(sub, std::move(run));
  }
  return [parts = std::move(parts)]() -> Expected<int> {
    for (const auto& [sub, run] : parts) {
      if (sub->parsed()) {
        return run();
      }
    }
    return make_error(ErrorKind::kInternal, "no part of `rayloc scene` was chosen");
  };
}

}  // namespace

extern const Verb kScene;
const Verb kScene = {
    "scene", "Make, check and draw scenes", "rayloc scene room --help", declare_scene_parts};

}  // namespace rayloc::cli
