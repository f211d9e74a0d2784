// Where `rayloc top` asks for what was last said, where it is not told where.
#pragma once

#include <optional>
#include <string>

namespace rayloc::cli {

// Of a raylocd that publishes at the usual port, 5560, the usual port of snapshots on the same
// machine, 5561; nothing for other endpoints, of which it is not known what answers beside them.
std::optional<std::string> usual_snapshot(const std::string& endpoint);

}  // namespace rayloc::cli
