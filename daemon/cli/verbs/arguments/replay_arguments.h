// Command-line options of `rayloc replay`, and their values for the replay itself.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "capture/source/record_times.h"
#include "daemon/cli/command/option_parser.h"
#include "daemon/cli/verbs/arguments/method_arguments.h"
#include "daemon/lab/replay/replay.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/pipeline/device/chain_keeper.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct ReplayArguments {
  std::string site;
  std::vector<std::string> captures;
  MethodArguments method;
  std::string stream;    // address of a broker; empty: use the captures
  BrokerOptions broker;  // credentials for the broker
  bool uninterrupted = false;
  bool fill = false;
  std::string stream_site;  // its name there; empty: as in site.toml
  std::string kind = "all";
  std::string burst = "0.2s";
  std::string speed = "max";
  double max_gap = to_seconds(kMaxGap);
  std::string format = "jsonl";
  std::string out = "-";
  std::string zone_events;  // file; empty: not written
  int threads = 0;
  std::optional<double> height_sigma;  // [m]; empty: the site's values
  std::string target_key;              // file; empty: devices are named by their addresses
  double target_rotate_h = 24.0;
  ChainKeeper::Options chains;
  std::string snapshots = "always";
  std::string from;          // empty: the beginning, or the end of the records
  double warm_up = 5.0;      // [s]
  std::string carried;       // file; empty: no carried records
  std::string carried_out;   // file; empty: not written
  double carried_every = 1;  // [s]
  bool no_cache = false;
  bool quiet = false;
};

// `arguments` must outlive the parser.
void add_replay_options(OptionParser& app, ReplayArguments& arguments);

// Options that contradict each other or the method are refused (kUsage).
Expected<replay::Options> replay_options(const ReplayArguments& arguments);

// An Error (kUsage) for a speed that cannot be parsed.
Expected<replay::Recordings> replay_recordings(const ReplayArguments& arguments);

replay::WarmOptions warm_replay(const ReplayArguments& arguments);

// The site under its name in the cluster, with the heights of the command line.
Expected<Site> replay_site(const ReplayArguments& arguments);

}  // namespace rayloc::cli
