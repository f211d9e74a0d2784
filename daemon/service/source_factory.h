// From [[source]] of the configuration to an open source, ready for the pipeline.
#pragma once

#include "daemon/pipeline/source_worker.h"
#include "daemon/service/config.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"

namespace rayloc {

// Opens the socket, interface or file. The error names the source's place in the configuration.
Expected<SourceWorker::Input> open_source(const SourceConfig& source,
                                          const DaemonConfig& config,
                                          const Site& site);

// Arrival stamps of such a source are of this machine's clock.
inline bool is_live(const SourceConfig& source) { return source.kind != SourceKind::kPcap; }

}  // namespace rayloc
