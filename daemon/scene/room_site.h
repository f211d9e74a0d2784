// room_site: the site.toml of a room made from a plan.
#pragma once

#include <string>

#include "daemon/scene/room_plan.h"

namespace rayloc {

// The text of site.toml, beside scene.xml: name, bounds, carrier, access points. Without an access
// point in the plan it lacks one, and says in a comment what to write.
std::string room_site(const RoomPlan& plan);

}  // namespace rayloc
