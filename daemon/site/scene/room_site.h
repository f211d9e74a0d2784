// room_site: the site.toml of a room made from a plan.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "daemon/site/scene/room_plan.h"

namespace rayloc {

// The text of site.toml, beside scene.xml: name, bounds, carrier, access points. Without an access
// point in the plan none is written, and a comment contains a template: a block with the antennas
// of a known model. With `model` (access_point_presets.h) that block is no comment.
std::string room_site(const RoomPlan& plan, std::string_view model = {});

// Antenna gain tables: the name in site.toml, and the file that the plan names.
std::map<std::string, std::filesystem::path> room_pattern_files(const RoomPlan& plan);

}  // namespace rayloc
