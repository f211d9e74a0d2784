// `method` of [engine] and of a site: one method, or several of which the first is the site's and
// the others are compared with it (daemon/pipeline/compare).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/live/config/config_reader.h"

namespace rayloc {

// A text, or an array of different ones; an array of one counts as its text. Errors refer to the
// entry that is wrong.
std::optional<ConfigValue> read_methods(const TomlTable& table, const ConfigOption& option);

// Errors for compared methods where only one may be stated: on a worker of a cluster.
void check_methods(const TomlTable& root, const ConfigReading& reading);

// Errors for methods that cannot locate at that site, the `index`-th: no training exists there, or
// it has no target of their kind. Otherwise the places that state them, the site's own first:
// "raylocd.toml:4:11: "; empty for a default.
std::vector<std::string> check_methods_of(const TomlTable& root,
                                          const ConfigReading& reading,
                                          const Site& site,
                                          std::size_t index);

}  // namespace rayloc
