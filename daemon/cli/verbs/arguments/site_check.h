// Checks that raylocd would locate with a site: the site part of `rayloc check-config`.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"

namespace rayloc::cli {

// Returns the good findings as text and prints what is missing. An Error names each problem.
Expected<std::string> check_site(const std::filesystem::path& folder);

}  // namespace rayloc::cli
