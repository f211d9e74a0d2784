// Checks of [cluster] in raylocd's configuration beyond the table of keys.
#pragma once

#include "daemon/live/config/config.h"
#include "daemon/site/model/toml_reader.h"

namespace rayloc {

// True if [cluster] configures a worker or a gateway, which have no own sources.
bool has_no_sources(const TomlTable& root);

// Errors are recorded in the document: a role without servers or without a name, a worker or a
// gateway with sources, or with [site].
void check_cluster(const TomlTable& root, const ClusterConfig& cluster);

}  // namespace rayloc
