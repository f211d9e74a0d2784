// From [[source]] of the configuration to an open source, ready for the pipeline.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "capture/source/recording_plan.h"
#include "daemon/config/config.h"
#include "daemon/config/source_url.h"
#include "daemon/pipeline/playback/paced_source.h"
#include "daemon/pipeline/playback/playback.h"
#include "daemon/pipeline/source_worker.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"

namespace rayloc {

// The one clock that the recordings of a configuration share, so that they stay in step.
struct RecordingClock {
  // Where all sources are files: people can hold, hasten and move it.
  std::shared_ptr<Playback> playback = nullptr;
  // Otherwise, beside live sources and of pipes; null: as fast as it goes.
  std::shared_ptr<Pace> pace = nullptr;
  // The files of each, looked through, by access point.
  std::map<std::string, RecordingPlan> plans = {};
};
// Reads files to their ends, to know how long they are and which of their stamps hold; logs what
// people should know of that.
Expected<RecordingClock> recording_clock(const DaemonConfig& config);

// Opens the socket, interface or file; of a UDP source `passed_socket` instead, where there is one.
// The error names the source's place in the configuration.
Expected<SourceWorker::Input> open_source(const SourceConfig& source,
                                          const Site& site,
                                          std::optional<int> passed_socket,
                                          const RecordingClock& clock);

// What a pipeline is to know of a source that is open.
SourceWorker::Input source_input(const SourceConfig& config,
                                 const Site& site,
                                 std::unique_ptr<DatagramSource> source);

// Whether the socket or the interface of a live source can be had, by having it for an instant.
Expected<void> check_source(const SourceConfig& source);

}  // namespace rayloc
