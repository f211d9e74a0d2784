// What site.toml may state, in words and for programs: printed from the table of keys that its
// parser reads by (daemon/site/keys/site_keys.h).
#pragma once

#include <string>

namespace rayloc {

// The manual page site.toml(5), in the man macros of roff.
std::string site_manual_page();

// A JSON schema (draft 2020-12) of the file, for editors. What a table alone cannot say (tones that
// fill the band, outlines that cross themselves) only the parser finds.
std::string site_json_schema();

}  // namespace rayloc
