// Default snapshot endpoint of `rayloc top`, used when none is given.
#pragma once

#include <optional>
#include <string>

namespace rayloc::cli {

// For a raylocd that publishes at the usual port, 5560, returns the usual snapshot port
// on the same machine, 5561; nothing for other endpoints, whose snapshot port is unknown.
std::optional<std::string> usual_snapshot(const std::string& endpoint);

}  // namespace rayloc::cli
