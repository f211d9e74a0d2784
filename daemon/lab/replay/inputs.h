// Opens the recordings of a replay as the inputs of a pipeline.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/source/record_times.h"
#include "capture/source/recorded_source.h"
#include "daemon/methods/method_registry.h"
#include "daemon/pipeline/source_lane.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::replay {

struct Recordings {
  std::vector<std::string> captures;  // "[AP=]FILE"; several of one AP are a sequence
  std::optional<double> speed;        // recorded seconds per second; empty: as fast as possible
  Duration max_gap = kMaxGap;         // a paced replay waits no longer than that
};

// With pointers for the final summary: the pipeline owns the sources.
struct Inputs {
  std::vector<SourceInput> inputs;
  std::vector<const RecordedSource*> sources;  // in the order of the inputs
  std::vector<std::size_t> access_points;      // by input, index in the site
};

// Datagrams before `listen_from` are left out. Errors: a capture of no access point of the site; a
// file that cannot be read as a capture.
Expected<Inputs> open_inputs(const Recordings& recordings,
                             const Site& site,
                             const Method& method,
                             Timestamp listen_from);

}  // namespace rayloc::replay
