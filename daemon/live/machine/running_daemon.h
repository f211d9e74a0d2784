// Checks if a raylocd runs with a configuration, in any state: one that is starting sends no
// responses yet, but has bound its ports or will bind them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>

namespace rayloc {

// Its process, as visible to this user in /proc; empty when none is found.
std::optional<pid_t> running_daemon(const std::filesystem::path& configuration);

}  // namespace rayloc
