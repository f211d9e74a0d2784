// Connection of `rayloc top`, which begins with the last message of each topic.
#pragma once

#include <optional>
#include <string>

#include "daemon/cli/feed/message_source.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// For a raylocd that publishes at the usual port, 5560, returns the usual snapshot port
// on the same machine, 5561; nothing for other endpoints, whose snapshot port is unknown.
std::optional<std::string> usual_snapshot(const std::string& endpoint);

// Connects with a snapshot of the last messages, so that zones and quiet targets are available at
// once. If no snapshot is given or found at the usual address within `patience` [s], 2 s at most,
// it connects without one.
Expected<Receive> connect_with_snapshot(const MessageSource& from, double patience);

}  // namespace rayloc::cli
