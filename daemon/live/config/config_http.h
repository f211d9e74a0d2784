// Checks of [http] in raylocd's configuration beyond the table of keys.
#pragma once

#include "daemon/live/config/config.h"
#include "daemon/site/model/toml_reader.h"

namespace rayloc {

// Errors are recorded in the document: an address that strangers reach without a token, an invalid
// path or origin.
void check_http(const TomlTable& root, const HttpConfig& http);

}  // namespace rayloc
