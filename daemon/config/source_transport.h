// From a [[source]] to its transport and back (capture/source/transport_schemes.h).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "capture/transport/transport_scheme.h"
#include "daemon/config/config.h"
#include "daemon/site/toml_reader.h"

namespace rayloc {

// The key `url` of a table; notes an error and returns nothing where raylocd cannot read it.
std::optional<TransportAddress> read_source_url(const TomlTable& table);

// Which keys such a source has: "udp", "pcap", "interface", "unix", or "url" for none of its own.
std::string_view kind_of(const TransportScheme& scheme);

// Stores the address as the key of that kind would ("listen", "file", ...).
void store_source_url(const TomlTable& table, const TransportAddress& url, SourceConfig& source);

}  // namespace rayloc
