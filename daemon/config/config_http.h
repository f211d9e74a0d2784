// What [http] of raylocd's configuration must be beside the table of keys.
#pragma once

#include "daemon/config/config.h"
#include "daemon/site/toml_reader.h"

namespace rayloc {

// Errors are noted in the document: an address that strangers reach without a token, a path or an
// origin that is none.
void check_http(const TomlTable& root, const HttpConfig& http);

}  // namespace rayloc
