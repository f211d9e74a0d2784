// room_findings: checks that the scene is the room that the site states.
//
// A scene in centimetres, with y up or with its origin in another corner is read without an error,
// and every fix in it is wrong. Other statements of the site reveal it: [bounds], the positions of
// antennas. Without a site only dimensions that no room has are found.
#pragma once

#include <string>
#include <vector>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/scene/scene.h"

namespace rayloc {

struct SiteAntenna {
  std::string name;  // "the antenna of core 2 of access point 'ap1'"
  Vec3d place;       // [m]
};
// Every antenna whose position the site states: those of access points and fixed transmitters.
std::vector<SiteAntenna> antennas_of(const Site& site);

struct RoomFinding {
  // An error: fixes in this room would be wrong. Otherwise suspect, possibly intended.
  bool is_error = false;
  // For scripts: unit, axes, origin, scale, no_ceiling, bounds, antenna_outside.
  std::string kind;
  std::string message;  // for people, begins with the error
};

// `site`: that of the scene, or nullptr. One mistake is one finding: if the unit is wrong, antennas
// outside are not reported.
std::vector<RoomFinding> room_findings(const Scene& scene, const Site* site);

// An Error with all findings that are errors, as "SCENE: message" lines.
Expected<void> check_room(const Scene& scene, const Site& site);

// Findings that are allowed and probably mistakes, as "PLACE: warning: message": the findings that
// are no errors, then zone_warnings().
std::vector<std::string> room_warnings(const Scene& scene, const Site& site);

}  // namespace rayloc
