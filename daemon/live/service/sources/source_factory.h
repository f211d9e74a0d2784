// From [[source]] of the configuration to an open source, ready for the pipeline.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "capture/source/recording_plan.h"
#include "daemon/live/config/config.h"
#include "daemon/live/config/source_url.h"
#include "daemon/pipeline/playback/paced_source.h"
#include "daemon/pipeline/playback/playback.h"
#include "daemon/pipeline/source_worker.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"

namespace rayloc {

// The one clock that the recordings of a configuration share, so that they stay synchronised.
struct RecordingClock {
  // Where all sources are files: the user can pause, accelerate and seek it.
  std::shared_ptr<Playback> playback = nullptr;
  // Otherwise, beside live sources and of pipes; null: at maximum speed.
  std::shared_ptr<Pace> pace = nullptr;
  // Examined files of each access point.
  std::map<std::string, RecordingPlan> plans = {};
};
// Reads files to their ends, to determine their lengths and valid time stamps; logs notes for the
// operator.
Expected<RecordingClock> recording_clock(const DaemonConfig& config);

// Opens the socket, interface or file; of a UDP source `passed_socket` instead, if there is one.
// The error names the source's place in the configuration. `method`: it locates from the frames;
// null: none does.
Expected<SourceWorker::Input> open_source(const SourceConfig& source,
                                          const Site& site,
                                          const Method* method,
                                          std::optional<int> passed_socket,
                                          const RecordingClock& clock);

// Input of a pipeline for an open source.
SourceWorker::Input source_input(const SourceConfig& config,
                                 const Site& site,
                                 const Method* method,
                                 std::unique_ptr<DatagramSource> source);

// Checks that the socket or the interface of a live source is available, by opening it briefly.
Expected<void> check_source(const SourceConfig& source);

}  // namespace rayloc
