// Input for opening a [[source]]: the URL of its transport (capture/source/transport_schemes.h),
// and its further options.
#pragma once

#include <string>

#include "capture/transport/transport_scheme.h"
#include "daemon/live/config/config.h"
#include "engine/base/expected.h"

namespace rayloc {

// "udp:0.0.0.0:5500". A recording has one for its first file (recording_files.h has them all).
std::string source_url(const SourceConfig& source);

// The options without a socket to adopt.
Expected<SourceOptions> source_options(const SourceConfig& source);

// Arrival stamps of such a source come from this machine's clock.
inline bool is_live(const SourceConfig& source) { return source.kind != SourceKind::kPcap; }

}  // namespace rayloc
