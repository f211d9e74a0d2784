// Converts a [[source]] to its transport and back (capture/source/transport_schemes.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "capture/transport/transport_scheme.h"
#include "daemon/live/config/config.h"
#include "daemon/site/model/toml_reader.h"

namespace rayloc {

// The key `url` of a table; records an error and returns empty if raylocd cannot read it.
std::optional<TransportAddress> read_source_url(const TomlTable& table);

// The set of keys of such a source: "udp", "pcap", "interface", "unix", or "url" without own keys.
std::string_view kind_of(const TransportScheme& scheme);

// Stores the address like the key of that kind ("listen", "file", ...).
void store_source_url(const TomlTable& table, const TransportAddress& url, SourceConfig& source);

}  // namespace rayloc
