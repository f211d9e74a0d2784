// Converts site.toml to a draft, and a changed draft to
// site.toml: only differences are written, in place.
#pragma once

#include <filesystem>
#include <string>

#include "daemon/live/studio/site_draft.h"
#include "engine/base/expected.h"

namespace rayloc {

// Reads the access points, zones and transmitters that the text contains; it need not be a complete
// site. Returns an Error if it is no TOML.
Expected<SiteDraft> read_site_text(const std::string& text, const std::filesystem::path& file);

// The text with the values of `draft`. Returns an Error if a value cannot be written in place, or
// if the result does not read back as the draft.
Expected<std::string> edit_site_text(const std::string& text,
                                     const std::filesystem::path& file,
                                     const SiteDraft& draft);

// "[1.2, 0, 2.1]", to a tenth of a millimetre, in the usual notation.
std::string number_text(double value);

}  // namespace rayloc
