// site.toml as a draft, and a changed draft as site.toml: only what differs is written, where it
// stands.
#pragma once

#include <filesystem>
#include <string>

#include "daemon/studio/site_draft.h"
#include "engine/base/expected.h"

namespace rayloc {

// Of access points, zones and transmitters what can be read of the text, which need not be a whole
// site yet. An Error where it is no TOML.
Expected<SiteDraft> read_site_text(const std::string& text, const std::filesystem::path& file);

// The text with what `draft` says. An Error where it cannot be written there, or where the result
// does not read back as the draft.
Expected<std::string> edit_site_text(const std::string& text,
                                     const std::filesystem::path& file,
                                     const SiteDraft& draft);

// "[1.2, 0, 2.1]", to a tenth of a millimetre, as people write it.
std::string number_text(double value);

}  // namespace rayloc
