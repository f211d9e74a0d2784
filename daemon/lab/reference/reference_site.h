// write_reference_site: writes a site with its learned reference into a folder.
#pragma once

#include <filesystem>

#include "daemon/lab/reference/learn_reference.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc {

// Creates `out` with a copy of `site`, reference.toml, and the reports of the calibration. The
// calibration is unchanged, or has today's gains of the chains that are rotated. An Error if `out`
// is not empty (unless `force`), or a file cannot be read or written.
Expected<void> write_reference_site(const Site& site,
                                    const LearnedReference& learned,
                                    const std::filesystem::path& out,
                                    bool force);

}  // namespace rayloc
