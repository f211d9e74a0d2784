// The counters of all stages as the messages Heartbeat and SourceState.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/live/http/http_server.h"
#include "daemon/live/output/site_output.h"
#include "daemon/live/publish/snapshot_server.h"
#include "daemon/pipeline/clock_offset.h"
#include "daemon/pipeline/compare/compared_method.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/person_estimator.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/playback/playback.h"
#include "daemon/pipeline/record/recorder_stage.h"
#include "daemon/pipeline/record/ring_snapshots.h"
#include "daemon/site/model/site.h"

namespace rayloc {

// Sources of the numbers; all outlive the calls of status_messages().
struct StatusSources {
  const Pipeline* pipeline = nullptr;
  const SiteOutput* output = nullptr;
  const DeviceEstimator* estimator = nullptr;   // null: no target is located
  const PersonEstimator* people = nullptr;      // null: no people are located
  std::vector<const ComparedMethod*> compared;  // empty with one method
  std::vector<const RecorderStage*> recorders;
  std::uint64_t recordings_repaired = 0;          // at the start
  const SnapshotServer* snapshots = nullptr;      // of last messages
  const RingSnapshots* ring_snapshots = nullptr;  // null: no rings are kept
  const HttpServer* http = nullptr;               // null: no HTTP server
  std::shared_ptr<ClockOffset> clock;
  std::shared_ptr<const Playback> playback;  // null unless recordings are played
  struct Source {
    bool live = false;       // arrival stamps are of this machine's clock
    Duration stall_after{};  // a longer silence counts as stalled
  };
  std::vector<Source> sources;
  Timestamp started;
  std::optional<v1::ReloadCounters> reloads;  // of [[site]]
  std::uint64_t epoch = 0;
  std::string scene_hash;
  std::string calibration_id;
  std::optional<Georeference> georeference;
  std::function<std::vector<std::string>()> warnings;  // of Heartbeat; may be empty
};

// As in the heartbeat and in /api/v1/playback.
v1::Playback playback_message(const Playback::State& state);

StatusMessages status_messages(const StatusSources& sources, Timestamp now);

// The counters that all sites share, and no others: of the publisher, of late subscribers and of
// HTTP. Only these members of `sources` are read.
v1::Heartbeat shared_counters(const PublishedCounters& published, const StatusSources& sources);

}  // namespace rayloc
