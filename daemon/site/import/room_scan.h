// Reads room scans of phones: the JSON of a CapturedRoom or CapturedStructure of Apple's RoomPlan
// (developer.apple.com/documentation/roomplan).
#pragma once

#include <filesystem>

#include "daemon/site/import/model.h"
#include "engine/base/expected.h"

namespace rayloc {

// Lists `walls`, `doors`, `windows`, `openings`, `floors` and `objects` of boxes: `dimensions` [m]
// along their own x, y, z, and `transform`, the pose of their centre: 16 numbers, column by column,
// y up. Walls are sheets of their third dimension's thickness, or of the material's if that is 0.
// Doors that are not open and windows are panes in them. Objects are boxes named by category.
//
// The longest wall is aligned with x, the lower left corner of the walls is the origin. Unknown,
// bent, leaning or low-confidence parts are reported in the remarks.
Expected<Model> read_room_scan(const std::filesystem::path& file);

}  // namespace rayloc
