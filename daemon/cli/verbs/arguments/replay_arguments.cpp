#include "daemon/cli/verbs/arguments/replay_arguments.h"

#include <cstdio>
#include <memory>
#include <utility>

#include "daemon/cli/arguments/time_arguments.h"
#include "daemon/cli/verbs/cluster/cluster_verbs.h"
#include "daemon/site/model/path_grid_files.h"

namespace rayloc::cli {
namespace {

replay::Kind replay_kind(const std::string& kind) {
  return kind == "device"   ? replay::Kind::kDevice
         : kind == "person" ? replay::Kind::kPerson
                            : replay::Kind::kAll;
}

// Returns nullptr if grids are not to be kept, or if there is no folder for them.
std::shared_ptr<PathGridStore> path_grids(const ReplayArguments& arguments) {
  const auto directory = arguments.no_cache ? std::nullopt : cache_directory();
  if (!directory) {
    return nullptr;
  }
  PathGridFiles::Options files;
  files.directory = *directory;
  if (!arguments.quiet) {
    files.log = [](const std::string& line) {
      std::fprintf(stderr, "rayloc replay: cache: %s\n", line.c_str());
    };
  }
  return std::make_shared<PathGridFiles>(std::move(files));
}

// Options that contradict each other.
Expected<void> check_replay_inputs(const ReplayArguments& arguments) {
  if (arguments.fill && (arguments.stream.empty() || arguments.uninterrupted)) {
    return make_error(ErrorKind::kUsage, "--fill goes with --stream, and without --uninterrupted");
  }
  if (arguments.captures.empty() == arguments.stream.empty()) {
    return make_error(ErrorKind::kUsage, "name recordings, or a broker by --stream");
  }
  return {};
}

void add_stream_options(OptionParser& app, ReplayArguments& arguments) {
  app.add_option("--stream",
                 arguments.stream,
                 "reads the streams of a cluster's broker, \"nats://HOST:4222\", instead of "
                 "recordings, and repeats the results that its workers published for the site");
  app.add_option("--stream-site",
                 arguments.stream_site,
                 "name of the site in the cluster; default: the name in site.toml");
  app.add_flag("--uninterrupted",
               arguments.uninterrupted,
               "with --stream: the results of one worker for all of it, at the same instants");
  app.add_flag(
      "--fill",
      arguments.fill,
      "with --stream: only frames that reached the workers too late because the broker was absent");
  add_identity_options(app, arguments.broker);
}

void add_estimator_options(OptionParser& app, ReplayArguments& arguments) {
  app.add_option("--target-key",
                 arguments.target_key,
                 "hash devices' addresses as raylocd does with this [privacy] key_file");
  app.add_option("--target-rotate-h", arguments.target_rotate_h, "its rotate_h")
      ->check(in_range(0.01, 8760.0))
      ->capture_default_str();
  app.add_option(
      "--chains", arguments.chains.read, "file with the chain gains that were learned before");
  app.add_option(
      "--chains-out", arguments.chains.write, "file for the chain gains that are learned");
  app.add_option("--snapshots",
                 arguments.snapshots,
                 "fixes of single bursts over the whole room: of every burst (always), or of "
                 "devices without a track (acquire)")
      ->check(one_of({"always", "acquire"}))
      ->capture_default_str();
}

void add_warm_options(OptionParser& app, ReplayArguments& arguments) {
  app.add_option(
      "--from",
      arguments.from,
      "write no results of instants before this time, as in locations: 2024-06-10T06:13:35.5Z");
  app.add_option("--warm-up",
                 arguments.warm_up,
                 "seconds before that from which frames are processed, without results")
      ->check(in_range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--carried",
                 arguments.carried,
                 "file of --carried-out: go on with its bursts, numbers and stays in zones, as if "
                 "there had been no break; without --from, from the last record on");
  app.add_option("--carried-out",
                 arguments.carried_out,
                 "file for what a replay needs that is to go on from there, a record a line");
  app.add_option("--carried-every",
                 arguments.carried_every,
                 "seconds of the recording from one record to the next")
      ->check(in_range(0.01, 3600.0))
      ->capture_default_str();
}

}  // namespace

void add_replay_options(OptionParser& app, ReplayArguments& arguments) {
  app.add_option("site", arguments.site, "directory with site.toml")->required();
  app.add_option("captures",
                 arguments.captures,
                 "[AP=]FILE: pcap, pcapng, .gz, the .dat log of an Intel 5300, or - for stdin; "
                 "several of one AP are a sequence in "
                 "order of time");
  add_stream_options(app, arguments);
  add_method_options(app, arguments.method);
  app.add_option("--kind",
                 arguments.kind,
                 "targets to locate: device, person (needs `rayloc reference`), or all that the "
                 "site can")
      ->check(one_of({"device", "person", "all"}))
      ->capture_default_str();
  app.add_option("--burst", arguments.burst, "length of a burst of frames")->capture_default_str();
  app.add_option("--speed", arguments.speed, "max, or N times the recorded pace")
      ->capture_default_str();
  app.add_option("--max-gap",
                 arguments.max_gap,
                 "seconds of the recordings that --speed waits at most where they hold nothing, or "
                 "the clock was set")
      ->check(in_range(0.1, 1e9))
      ->capture_default_str();
  app.add_option("--format", arguments.format, "jsonl, or varint-delimited protobuf")
      ->check(one_of({"jsonl", "pb"}))
      ->capture_default_str();
  app.add_option("--out", arguments.out, "file to write instead of standard output");
  app.add_option("--zone-events",
                 arguments.zone_events,
                 "file for the events of the zones of the site, one ZoneEvent a line");
  app.add_option("--height-sigma",
                 arguments.height_sigma,
                 "standard deviation of the devices' heights [m], instead of the site's "
                 "height_sigma_m; 0: they are known")
      ->check(in_range(kHeightSigmaRange.min, kHeightSigmaRange.max));
  app.add_option("--threads", arguments.threads, "number of engine threads; 0: one per core")
      ->check(in_range(0, 1024))
      ->capture_default_str();
  add_estimator_options(app, arguments);
  add_warm_options(app, arguments);
  app.add_flag("--no-cache",
               arguments.no_cache,
               "trace the room anew; else its rays are kept in $XDG_CACHE_HOME/rayloc");
  app.add_flag("--quiet", arguments.quiet, "no summary on standard error");
}

Expected<replay::Options> replay_options(const ReplayArguments& arguments) {
  RAYLOC_TRY(check_replay_inputs(arguments));
  replay::Options options;
  replay::EstimatorOptions& estimators = options.estimators;
  estimators.kind = replay_kind(arguments.kind);
  estimators.method = find_method(arguments.method.name);
  RAYLOC_TRY(replay::check_kind(*estimators.method, estimators.kind));
  auto settings = method_options(arguments.method);
  RAYLOC_TRY(settings);
  const Expected<Duration> burst = parse_burst_argument(arguments.burst);
  RAYLOC_TRY(burst);
  options.burst = *burst;
  estimators.settings = *std::move(settings);
  estimators.path_grids = path_grids(arguments);
  estimators.target_key = arguments.target_key;
  estimators.target_period = from_seconds(3600.0 * arguments.target_rotate_h);
  estimators.chains = arguments.chains;
  estimators.snapshots =
      arguments.snapshots == "acquire" ? Snapshots::kAcquire : Snapshots::kAlways;
  return options;
}

Expected<replay::Recordings> replay_recordings(const ReplayArguments& arguments) {
  const auto speed = parse_speed_argument(arguments.speed);
  RAYLOC_TRY(speed);
  return replay::Recordings{arguments.captures, *speed, from_seconds(arguments.max_gap)};
}

replay::WarmOptions warm_replay(const ReplayArguments& arguments) {
  return {arguments.from, from_seconds(arguments.warm_up), arguments.carried};
}

Expected<Site> replay_site(const ReplayArguments& arguments) {
  Expected<Site> site = load_site(arguments.site);
  if (site && !arguments.stream_site.empty()) {
    site->name = arguments.stream_site;
  }
  if (site && arguments.height_sigma) {
    replay::assume_height_sigma(*arguments.height_sigma, *site);
  }
  return site;
}

}  // namespace rayloc::cli
