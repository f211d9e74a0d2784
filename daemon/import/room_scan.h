// Reads what phones write of a room that they scanned: the JSON of a CapturedRoom or
// CapturedStructure of Apple's RoomPlan (developer.apple.com/documentation/roomplan).
#pragma once

#include <filesystem>

#include "daemon/import/model.h"
#include "engine/base/expected.h"

namespace rayloc {

// Lists `walls`, `doors`, `windows`, `openings`, `floors` and `objects` of boxes: `dimensions` [m]
// along their own x, y, z, and `transform`, which places their middle: 16 numbers, column by
// column, y up. Walls are sheets of their third dimension's thickness, of the material's where that
// is 0. Doors that are not open and windows are panes in them. Objects are boxes named by category.
//
// The longest wall comes to lie along x, the lower left corner of the walls is the origin. What is
// unknown, bent, leaning or seen with low confidence is said in the remarks.
Expected<Model> read_room_scan(const std::filesystem::path& file);

}  // namespace rayloc
