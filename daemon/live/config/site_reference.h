// Documentation of site.toml, for people and for programs: generated from the table of keys that
// its parser uses (daemon/site/model/keys/site_keys.h).
#pragma once

#include <string>

namespace rayloc {

// The manual page site.toml(5), in the man macros of roff.
std::string site_manual_page();

// A JSON schema (draft 2020-12) of the file, for editors. Constraints beyond a table of keys (tones
// that fill the band, outlines that cross themselves) are checked by the parser only.
std::string site_json_schema();

}  // namespace rayloc
