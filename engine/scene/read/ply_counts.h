// Finds the count of a PLY header that does not fit the body. Internal to read_ply.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/scene/read/ply_header.h"

namespace rayloc {

// True if the body is read to its end: every entry begins a line of its own in text, every face has
// three corners or more, all of them among the vertices.
bool has_regular_body(std::string_view bytes, const PlyHeader& header);

struct PlyMiscount {
  std::string message;        // begins with the file's name and names both counts
  bool is_left_over = false;  // the last element has more entries; all counted ones are readable
};

// The single count whose change makes the body regular. Nothing when the header's counts fit, or
// when no single count explains the body.
std::optional<PlyMiscount> find_miscount(std::string_view bytes,
                                         const std::string& name,
                                         const PlyHeader& header);

}  // namespace rayloc
