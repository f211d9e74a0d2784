// Whether a raylocd runs with a configuration, whatever it has come to: one that is starting
// answers nobody yet, and has its ports or will have them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>

namespace rayloc {

// Its process, by what /proc tells this user; nothing when none is seen.
std::optional<pid_t> running_daemon(const std::filesystem::path& configuration);

}  // namespace rayloc
