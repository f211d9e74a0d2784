// Whether raylocd would locate with a site: what `rayloc check-config` says of its folder.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"

namespace rayloc::cli {

// In words what is good; what it lacks is printed. An Error names each thing that is wrong.
Expected<std::string> check_site(const std::filesystem::path& folder);

}  // namespace rayloc::cli
