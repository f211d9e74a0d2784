// simulate_recordings: simulates and writes the recordings that a site's access points would make
// of a device at given points, and the truth.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/simulate/handling.h"
#include "daemon/lab/simulate/simulate_report.h"
#include "daemon/lab/simulate/transmissions.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/scene/scene_note.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

// One recording to make.
struct SimulatedOutput {
  std::string access_point;  // id in the site
  std::string file;          // pcap
};

struct SimulationOptions {
  std::string points;  // csv file: t_start,t_end,x,y,z, or t,x,y,z for a walk
  std::vector<SimulatedOutput> outputs;
  std::string impairments = "default";  // "default", "none" or a TOML file
  std::string transmitter;              // address or name; empty: the site's first device
  std::string channels;                 // as in channel_list.h; empty: the site's channel alone
  // `walk`, `channels` and `retry_share` follow from the other options.
  TransmissionOptions transmissions;
  Handling handling;
  std::string second_day;  // "default" or a TOML file; empty: the day of the calibration
  std::string truth;       // csv file to write, as truth_csv(); empty: none
  TraceOptions trace;      // ignored with `model_error`
  bool model_error = false;
  // The points are those of a person without a device; `transmitter` is a fixed one of the site.
  bool person = false;
  bool force = false;  // replace files that exist
};

// Progress is by recording and point. Notes: points that no path reaches, things that did not move.
struct SimulationObserver : Observer {
  std::function<void(const SceneNote& note)> on_scene_note;  // on the reading of the scene
};

// Writes `outputs` and `truth`. Errors: kUsage names the option of `rayloc simulate`; kUnavailable:
// a file that exists (without `force`) or cannot be written; others name the file of the input and
// the row. Recordings written before an error remain. Deterministic in `transmissions.seed`.
// Thread-safe for distinct files.
Expected<SimulatedTruth> simulate_recordings(const Site& site,
                                             const SimulationOptions& options,
                                             const SimulationObserver& observer);

}  // namespace rayloc
