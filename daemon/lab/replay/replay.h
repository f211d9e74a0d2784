// Replay: locates targets in recordings through the same pipeline as raylocd.
//
// prepare() checks the options against the site and loads all that is needed; run() locates,
// and take_notices() has what the operator should be informed of afterwards. The
// engine's parallel loops use as many threads as the caller's oneapi::tbb::global_control allows;
// the results are the same for any number.
//
// Thread safety: one thread; a replay starts the threads of its pipeline itself.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "capture/transport/datagram_source.h"
#include "daemon/base/observer.h"
#include "daemon/lab/replay/estimators.h"
#include "daemon/lab/replay/inputs.h"
#include "daemon/lab/replay/summary.h"
#include "daemon/lab/replay/warm_replay.h"
#include "daemon/messages/location.h"
#include "daemon/messages/target_event.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/warm/carried.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::replay {

struct Options {
  EstimatorOptions estimators;
  Duration burst = std::chrono::milliseconds(200);  // length of a burst of frames
};

// Called by one thread of the pipeline, in the order of the results.
struct Output {
  std::function<void(const Location&)> on_location;     // required; ordered by (time, target, kind)
  std::function<void(const ZoneEvent&)> on_zone_event;  // may be empty
  std::function<void(const Carried&)> on_carried;       // may be empty
};

struct Prepared {
  Site site;
  Options options;
  WarmStart start;
  Inputs inputs;
  Estimators estimators;
};

// For the operator, after a replay; each a line without newline.
struct Notices {
  std::vector<std::string> chains;  // changes of the receive chains
  std::string chain_progress;       // chains that are still being learned; empty: none
  std::vector<std::string> lacks;   // parts of the site that are missing for the requested kind
};

// Reads the scene and prepares the room: up to a minute. Errors: those of warm_start_of(),
// open_inputs() and make_estimators().
Expected<Prepared> prepare(const Site& site,
                           const Options& options,
                           const Recordings& recordings,
                           const WarmOptions& warm,
                           const Observer& observer);

// Returns when the recordings have ended. `carry_every`: event time from one carried record to the
// next; zero: no records. REQUIRES: the first call with `replay`.
Summary run(Prepared& replay, Duration carry_every, const Output& output);

// The notices since the last call.
Notices take_notices(Prepared& replay);

// Stored streams of datagrams, which include the promises of their sources.
struct Streams {
  std::vector<std::unique_ptr<DatagramSource>> sources;  // by access point of the site
  Timestamp from = Timestamp::min();                     // earlier results are not reported
  std::shared_ptr<const Carried> carried;                // state of the predecessor; null: none
};

// Locates in streams instead of recordings. Errors: those of make_estimators().
Expected<void> run_streams(const Site& site,
                           const Options& options,
                           Streams streams,
                           LocationSink& sink,
                           const Observer& observer);

// Sets the standard deviation of the heights [m] of all devices, including those that state their
// own.
void assume_height_sigma(double sigma, Site& site);

}  // namespace rayloc::replay
