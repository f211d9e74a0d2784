// What [cluster] of raylocd's configuration must be beside the table of keys.
#pragma once

#include "daemon/config/config.h"
#include "daemon/site/toml_reader.h"

namespace rayloc {

// Whether [cluster] says that it is a worker or a gateway, which hear nothing themselves.
bool has_no_sources(const TomlTable& root);

// Errors are noted in the document: a role without servers or without a name, a worker or
// a gateway with sources, or with [site].
void check_cluster(const TomlTable& root, const ClusterConfig& cluster);

}  // namespace rayloc
