// `rayloc replay`: runs a recording through the same pipeline as raylocd.
#include <cstddef>
#include <memory>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include "daemon/cli/command/verb.h"
#include "daemon/cli/feed/no_fix_reasons.h"
#include "daemon/cli/terminal/terminal_notes.h"
#include "daemon/cli/verbs/arguments/replay_arguments.h"
#include "daemon/cli/verbs/replay_cluster.h"
#include "daemon/cli/verbs/report/replay_files.h"
#include "daemon/cli/verbs/report/replay_report.h"
#include "daemon/lab/replay/replay.h"
#include "daemon/messages/location_message.h"

namespace rayloc::cli {
namespace {

Expected<void> write_results(const ReplayArguments& arguments, replay::Prepared& replay) {
  auto files = ReplayFiles::open(arguments.format,
                                 {arguments.out, arguments.zone_events, arguments.carried_out});
  RAYLOC_TRY(files);
  NoFixReasons reasons;
  replay::Output output;
  output.on_location = [&](const Location& location) {
    reasons.count(location);
    files->write_location(location_message(location));
  };
  output.on_zone_event = [&](const ZoneEvent& event) { files->write_event(event_message(event)); };
  output.on_carried = [&](const Carried& carried) { files->write_carried(carried); };
  const Duration carry_every =
      arguments.carried_out.empty() ? Duration{} : from_seconds(arguments.carried_every);
  const replay::Summary summary = replay::run(replay, carry_every, output);
  RAYLOC_TRY(files->close());
  return report_replay(summary, reasons.text(), arguments.quiet);
}

Expected<void> replay_captures(const ReplayArguments& arguments,
                               const Site& site,
                               const replay::Options& options) {
  const auto recordings = replay_recordings(arguments);
  RAYLOC_TRY(recordings);
  auto replay = replay::prepare(
      site, options, *recordings, warm_replay(arguments), terminal_notes(arguments.quiet));
  RAYLOC_TRY(replay);
  Expected<void> written = write_results(arguments, *replay);
  if (!arguments.quiet) {
    print_replay_notices(replay::take_notices(*replay));
  }
  return written;
}

Expected<void> run_replay_verb(const ReplayArguments& arguments) {
  const auto options = replay_options(arguments);
  RAYLOC_TRY(options);
  const Expected<Site> site = replay_site(arguments);
  RAYLOC_TRY(site);
  // Applies to the engine's parallel loops; the results are the same for any number.
  const oneapi::tbb::global_control threads(
      oneapi::tbb::global_control::max_allowed_parallelism,
      static_cast<std::size_t>(arguments.threads > 0 ? arguments.threads
                                                     : oneapi::tbb::info::default_concurrency()));
  return arguments.stream.empty() ? replay_captures(arguments, *site, *options)
                                  : replay_cluster(arguments, *site, *options);
}

RunVerb declare_replay(OptionParser& app) {
  const auto arguments = std::make_shared<ReplayArguments>();
  add_replay_options(app, *arguments);
  return [arguments] { return run_replay_verb(*arguments); };
}

}  // namespace

extern const Verb kReplay;
const Verb kReplay = {
    "replay",
    "Locate targets in recordings, as raylocd would have",
    "rayloc replay room/ ap1=monday.pcap ap2=monday-2.pcap.gz > locations.jsonl\n"
    "  rayloc replay room/ ap1=ring.pcap0 ap1=ring.pcap1 ap1=ring.pcap2 > locations.jsonl\n"
    "  rayloc replay room/ ap1=monday.pcap --method paper --multi-start 8 --seed 7\n"
    "  rayloc replay room/ ap1=monday.pcap --method paper --paper alpha=0.5 smoothing=false\n"
    "  rayloc replay room/ ap1=monday.pcap --method paper --start 0.3,-1.2\n"
    "  rayloc replay room/ ap1=monday.pcap --method spotfi --baseline range=room frames=20\n"
    "  rayloc replay room/ ap1=monday.pcap --likelihood ratio_complex --burst 1.2s\n"
    "  rayloc replay room/ ap1=monday.pcap --out locations.jsonl --zone-events zones.jsonl\n"
    "  rayloc replay room/ ap1=monday.pcap --carried-out carried.jsonl > locations.jsonl\n"
    "  rayloc replay room/ ap1=monday.pcap --carried carried.jsonl --from 2024-06-10T06:13:35Z\n"
    "  rayloc replay room/ --stream nats://127.0.0.1:4222 > locations.jsonl\n"
    "  rayloc replay room-people/ ap1=monday.pcap --kind person --burst 1.2s\n"
    "  rayloc replay room-people/ ap1=monday.pcap --kind person --method paper --seed 7",
    &declare_replay};

}  // namespace rayloc::cli
