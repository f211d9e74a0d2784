// The parts of `rayloc scene`, each in the file of its name (scene_room.cpp, ...).
#pragma once

#include "daemon/cli/command/verb.h"

namespace rayloc::cli {

RunVerb declare_scene_check(OptionParser& app);
RunVerb declare_scene_import(OptionParser& app);
RunVerb declare_scene_map(OptionParser& app);
RunVerb declare_scene_room(OptionParser& app);
RunVerb declare_scene_show(OptionParser& app);

}  // namespace rayloc::cli
