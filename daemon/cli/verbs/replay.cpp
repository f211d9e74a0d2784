// `rayloc replay`: runs a recording through the same pipeline as raylocd.
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/delimited_message_util.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include "capture/source/recorded_source.h"
#include "daemon/base/output_file.h"
#include "daemon/cli/arguments/time_arguments.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/feed/no_fix_reasons.h"
#include "daemon/cli/verbs/cluster_verbs.h"
#include "daemon/cli/verbs/method_arguments.h"
#include "daemon/cli/verbs/replay_cluster.h"
#include "daemon/cli/verbs/replay_estimators.h"
#include "daemon/cli/verbs/warm_replay.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/replay_report.h"
#include "daemon/messages/json.h"
#include "daemon/messages/location_message.h"
#include "daemon/methods/method_registry.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/playback/later_source.h"
#include "daemon/pipeline/playback/paced_source.h"
#include "daemon/pipeline/zones/zone_estimator.h"
#include "daemon/site/model/receiver_options.h"
#include "daemon/site/model/site.h"
#include "daemon/site/model/site_lacks.h"

namespace rayloc::cli {
namespace {

// Frame limit of a burst at an access point: above the number that any access point sends in it.
constexpr std::size_t kEveryFrame = 4096;

struct Options : EstimatorArguments {
  std::string site;
  std::vector<std::string> captures;
  MethodArguments method;
  std::string stream;    // address of a broker; empty: use the captures
  BrokerOptions broker;  // credentials for the broker
  bool uninterrupted = false;
  bool fill = false;
  std::string stream_site;  // its name there; empty: as in site.toml
  std::string burst = "0.2s";
  std::string speed = "max";
  double max_gap = to_seconds(kMaxGap);
  std::string format = "jsonl";
  std::string out = "-";
  std::string zone_events;  // file; empty: not written
  int threads = 0;
  std::optional<double> height_sigma;  // [m]; empty: the site's values
  WarmReplayArguments warm;
};

// The recordings of a replay, with pointers for the final report: the pipeline owns the sources.
struct ReplayRecordings {
  std::vector<SourceWorker::Input> inputs;
  std::vector<const RecordedSource*> sources;  // in the order of the inputs
  std::vector<int> access_points;              // by input, index in the site
};

Expected<ReplayRecordings> open_captures(const Options& options,
                                         const Site& site,
                                         Timestamp listen_from) {
  const auto captures =
      resolve_captures(options.captures, access_point_ids(site), PerAccessPoint::kSeveral);
  if (!captures) {
    return tl::make_unexpected(captures.error());
  }
  const auto speed = parse_speed_argument(options.speed);
  if (!speed) {
    return tl::make_unexpected(speed.error());
  }
  const Method& method = *find_method(options.method.name);
  PcapFileOptions file_options;
  file_options.max_gap = from_seconds(options.max_gap);
  const auto pace = *speed ? std::make_shared<Pace>(**speed, file_options.max_gap) : nullptr;
  ReplayRecordings all;
  for (const RecordingArgument& recording : recordings_of(*captures)) {
    auto source = RecordedSource::open(recording.files, file_options);
    if (!source) {
      return tl::make_unexpected(source.error());
    }
    const int index = *find_access_point(site, recording.access_point);
    SourceWorker::Input input;
    input.access_point = recording.access_point;
    all.sources.push_back(source->get());
    all.access_points.push_back(index);
    input.source = std::move(*source);
    if (listen_from != Timestamp::min()) {
      input.source = std::make_unique<LaterSource>(std::move(input.source), listen_from);
    }
    if (pace) {
      input.source = std::make_unique<PacedSource>(std::move(input.source), pace);
    }
    input.receiver = receiver_options(site, index);
    input.receiver.accepts_hops = method.uses_every_channel;
    all.inputs.push_back(std::move(input));
  }
  return all;
}

// Our own messages always have a JSON form.
void write(const google::protobuf::Message& message, const std::string& format, OutputFile& out) {
  if (format == "pb") {
    std::string bytes;
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::util::SerializeDelimitedToZeroCopyStream(message, &stream);
    out.write(bytes);
  } else {
    out.write(to_json(message).value() + "\n");
  }
}

Expected<void> check_targets(const Method& method, const std::string& kind) {
  const std::string name(method.name);
  if (kind == "device" && method.create_device == nullptr) {
    return make_error(ErrorKind::kUsage, "--method " + name + " locates people; use --kind person");
  }
  if (kind == "person" && method.create_person == nullptr) {
    return make_error(ErrorKind::kUsage,
                      "--method " + name + " locates devices; use --kind device");
  }
  return {};
}

// Writes carried records beside published messages.
class ReplaySink : public OrderedSink {
 public:
  using OrderedSink::OrderedSink;
  void write_carried_to(OutputFile* file) { carried_ = file; }
  void carried(Carried&& carried) override {
    if (carried_ != nullptr) {
      carried_->write(carried_line(carried));
    }
  }

 private:
  OutputFile* carried_ = nullptr;
};

// Returns empty if the file has no name.
Expected<std::optional<OutputFile>> open_optional(const std::string& file) {
  if (file.empty()) {
    return std::optional<OutputFile>();
  }
  Expected<OutputFile> opened = OutputFile::open(file);
  if (!opened) {
    return tl::make_unexpected(opened.error());
  }
  return std::optional<OutputFile>(std::move(*opened));
}

Expected<void> close_all(std::initializer_list<OutputFile*> files) {
  for (OutputFile* const file : files) {
    if (file != nullptr) {
      if (Expected<void> closed = file->close(); !closed) {
        return closed;
      }
    }
  }
  return {};
}

Expected<void> write_estimates(const Options& options,
                               const PipelineOptions& pipeline_options,
                               ReplayRecordings recordings,
                               Estimator& estimator) {
  Expected<OutputFile> out = OutputFile::open(options.out);
  if (!out) {
    return tl::make_unexpected(out.error());
  }
  auto events = open_optional(options.zone_events);
  auto carried = open_optional(options.warm.carried_out);
  for (const auto* const opened : {&events, &carried}) {
    if (!*opened) {
      return tl::make_unexpected(opened->error());
    }
  }
  NoFixReasons reasons;
  ReplaySink sink(
      [&](const Location& location) {
        reasons.count(location);
        write(location_message(location), options.format, *out);
      },
      [&](const ZoneEvent& event) {
        if (*events) {
          write(event_message(event), options.format, **events);
        }
      },
      find_method(options.method.name)->lag);
  sink.write_carried_to(*carried ? &**carried : nullptr);
  Pipeline pipeline(pipeline_options, std::move(recordings.inputs), estimator, sink);
  pipeline.start();
  pipeline.wait();
  sink.finish();
  if (Expected<void> closed =
          close_all({&*out, *events ? &**events : nullptr, *carried ? &**carried : nullptr});
      !closed) {
    return closed;
  }
  Expected<void> reported = report_replay(pipeline, recordings.sources, options.quiet);
  if (const std::string text = reasons.text(); !text.empty() && !options.quiet) {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
  return reported;
}

// Reports missing parts of the site for the requested kind, by recorded access points.
void report_lacks(const Options& options,
                  const Site& site,
                  const Estimators& estimators,
                  const std::vector<int>& received) {
  if (options.quiet || !estimators.devices) {  // with people only, each estimate reports it
    return;
  }
  const SiteLacks lacks = site_lacks(site, estimators.devices->room(), received);
  for (const std::string& lack : options.kind == "all" ? lacks.all() : lacks.obstacles) {
    std::fprintf(stderr, "rayloc replay: %s\n", lack.c_str());
  }
}

// Sets it for all devices, including those that state their own.
void assume_height_sigma(double sigma, Site& site) {
  site.targets.height_sigma = sigma;
  for (SiteTransmitter& transmitter : site.transmitters) {
    transmitter.height_sigma = sigma;
  }
}

PipelineOptions pipeline_options(const Method& method, Duration burst) {
  PipelineOptions options;
  options.burst.length = burst;
  options.overflow = Overflow::kWait;
  if (method.needs_every_frame) {
    options.burst.max_frames = kEveryFrame;
  }
  return options;
}

// Replays the owners of a site one after the other, each with estimators of its own.
Expected<void> run_stream(const Options& options,
                          const Site& site,
                          const MethodOptions& settings,
                          Duration burst) {
  const Method& method = *find_method(options.method.name);
  Expected<OutputFile> out = OutputFile::open(options.out);
  auto events = open_optional(options.zone_events);
  if (!out || !events) {
    return tl::make_unexpected(out ? events.error() : out.error());
  }
  StreamReplay replay;
  replay.site = site.name;
  replay.uninterrupted = options.uninterrupted;
  replay.access_points = access_point_ids(site);
  replay.on_result = [&](const v1::OutputItem& item) {
    if (item.has_location()) {
      write(item.location(), options.format, *out);
    } else if (item.has_zone() && *events) {
      write(item.zone(), options.format, **events);
    }
  };
  replay.run = [&](const SiteStart& start,
                   std::vector<std::unique_ptr<DatagramSource>> sources,
                   LocationSink& sink) -> Expected<void> {
    auto estimators = make_estimators(options, site, method, settings, start.carried);
    if (!estimators) {
      return tl::make_unexpected(estimators.error());
    }
    std::vector<SourceWorker::Input> inputs(sources.size());
    for (std::size_t i = 0; i < sources.size(); ++i) {
      inputs[i].access_point = site.access_points[i].id;
      inputs[i].source = std::move(sources[i]);
      inputs[i].receiver = receiver_options(site, static_cast<int>(i));
      inputs[i].receiver.accepts_hops = method.uses_every_channel;
    }
    PipelineOptions all = pipeline_options(method, burst);
    all.from = start.from;
    all.promises_are_kept = true;
    if (start.carried) {
      all.open = start.carried->open;
    }
    ZoneEstimator zones(estimators->all, site.zones, start.carried.get());
    Pipeline pipeline(all, std::move(inputs), zones, sink);
    pipeline.start();
    pipeline.wait();
    return {};
  };
  BrokerOptions broker = options.broker;
  broker.servers = {options.stream};
  broker.name = "rayloc replay";
  Expected<void> replayed = replay_cluster(broker, replay, options.fill, options.quiet);
  if (Expected<void> closed = close_all({&*out, *events ? &**events : nullptr}); !closed) {
    return closed;
  }
  return replayed;
}

// The site under its name in the cluster, with the heights of the command line.
Expected<Site> site_of(const Options& options) {
  Expected<Site> site = load_site(options.site);
  if (site && !options.stream_site.empty()) {
    site->name = options.stream_site;
  }
  if (site && options.height_sigma) {
    assume_height_sigma(*options.height_sigma, *site);
  }
  return site;
}

void report_chains(const Options& options, const Estimators& estimators) {
  if (options.quiet || !estimators.devices) {
    return;
  }
  for (const std::string& line : estimators.devices->chain_notices()) {
    std::fprintf(stderr, "rayloc replay: %s\n", line.c_str());
  }
  if (const std::string progress = estimators.devices->chain_progress(); !progress.empty()) {
    std::fprintf(stderr, "rayloc replay: at the end: %s\n", progress.c_str());
  }
}

Expected<void> run_replay(const Options& options) {
  if (options.fill && (options.stream.empty() || options.uninterrupted)) {
    return make_error(ErrorKind::kUsage, "--fill goes with --stream, and without --uninterrupted");
  }
  if (options.captures.empty() == options.stream.empty()) {
    return make_error(ErrorKind::kUsage, "name recordings, or a broker by --stream");
  }
  const Method& method = *find_method(options.method.name);
  if (auto checked = check_targets(method, options.kind); !checked) {
    return checked;
  }
  auto settings = method_options(options.method);
  if (!settings) {
    return tl::make_unexpected(std::move(settings.error()));
  }
  const Expected<Duration> burst = parse_burst_argument(options.burst);
  if (!burst) {
    return tl::make_unexpected(burst.error());
  }
  Expected<Site> site = site_of(options);
  if (!site) {
    return tl::make_unexpected(site.error());
  }
  // Applies to the engine's parallel loops; the results are the same for any number.
  const oneapi::tbb::global_control threads(
      oneapi::tbb::global_control::max_allowed_parallelism,
      static_cast<std::size_t>(options.threads > 0 ? options.threads
                                                   : oneapi::tbb::info::default_concurrency()));
  if (!options.stream.empty()) {
    return run_stream(options, *site, *settings, *burst);
  }
  const auto start = warm_start_of(options.warm);
  if (!start) {
    return tl::make_unexpected(start.error());
  }
  auto recordings = open_captures(options, *site, start->listen_from);
  if (!recordings) {
    return tl::make_unexpected(recordings.error());
  }
  auto estimators = make_estimators(options, *site, method, *settings, start->carried);
  if (!estimators) {
    return tl::make_unexpected(estimators.error());
  }
  PipelineOptions all = pipeline_options(method, *burst);
  all.open = start->open;
  all.from = start->from;
  if (!options.warm.carried_out.empty()) {
    all.carry_every = from_seconds(options.warm.carried_every);
  }
  ZoneEstimator zones(estimators->all, site->zones, start->carried.get());
  const std::vector<int> received = recordings->access_points;
  Expected<void> written = write_estimates(options, all, std::move(*recordings), zones);
  report_chains(options, *estimators);
  report_lacks(options, *site, *estimators, received);
  return written;
}

void add_stream_options(OptionParser& app, Options& options) {
  app.add_option("--stream",
                 options.stream,
                 "reads the streams of a cluster's broker, \"nats://HOST:4222\", instead of "
                 "recordings, and repeats the results that its workers published for the site");
  app.add_option("--stream-site",
                 options.stream_site,
                 "name of the site in the cluster; default: the name in site.toml");
  app.add_flag("--uninterrupted",
               options.uninterrupted,
               "with --stream: the results of one worker for all of it, at the same instants");
  app.add_flag(
      "--fill",
      options.fill,
      "with --stream: only frames that reached the workers too late because the broker was absent");
  add_identity_options(app, options.broker);
}

void add_output_options(OptionParser& app, Options& options) {
  app.add_option("--target-key",
                 options.target_key,
                 "hash devices' addresses as raylocd does with this [privacy] key_file");
  app.add_option("--target-rotate-h", options.target_rotate_h, "its rotate_h")
      ->check(in_range(0.01, 8760.0))
      ->capture_default_str();
  app.add_option(
      "--chains", options.chains.read, "file with the chain gains that were learned before");
  app.add_option("--chains-out", options.chains.write, "file for the chain gains that are learned");
  app.add_option("--snapshots",
                 options.snapshots,
                 "fixes of single bursts over the whole room: of every burst (always), or of "
                 "devices without a track (acquire)")
      ->check(one_of({"always", "acquire"}))
      ->capture_default_str();
}

RunVerb declare_replay(OptionParser& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("site", options->site, "directory with site.toml")->required();
  app.add_option("captures",
                 options->captures,
                 "[AP=]FILE: pcap, pcapng, .gz, the .dat log of an Intel 5300, or - for stdin; "
                 "several of one AP are a sequence in "
                 "order of time");
  add_stream_options(app, *options);
  add_method_options(app, options->method);
  app.add_option("--kind",
                 options->kind,
                 "targets to locate: device, person (needs `rayloc reference`), or all that the "
                 "site can")
      ->check(one_of({"device", "person", "all"}))
      ->capture_default_str();
  app.add_option("--burst", options->burst, "length of a burst of frames")->capture_default_str();
  app.add_option("--speed", options->speed, "max, or N times the recorded pace")
      ->capture_default_str();
  app.add_option("--max-gap",
                 options->max_gap,
                 "seconds of the recordings that --speed waits at most where they hold nothing, or "
                 "the clock was set")
      ->check(in_range(0.1, 1e9))
      ->capture_default_str();
  app.add_option("--format", options->format, "jsonl, or varint-delimited protobuf")
      ->check(one_of({"jsonl", "pb"}))
      ->capture_default_str();
  app.add_option("--out", options->out, "file to write instead of standard output");
  app.add_option("--zone-events",
                 options->zone_events,
                 "file for the events of the zones of the site, one ZoneEvent a line");
  app.add_option("--height-sigma",
                 options->height_sigma,
                 "standard deviation of the devices' heights [m], instead of the site's "
                 "height_sigma_m; 0: they are known")
      ->check(in_range(kHeightSigmaRange.min, kHeightSigmaRange.max));
  app.add_option("--threads", options->threads, "number of engine threads; 0: one per core")
      ->check(in_range(0, 1024))
      ->capture_default_str();
  add_output_options(app, *options);
  add_warm_replay_options(app, options->warm);
  app.add_flag("--no-cache",
               options->no_cache,
               "trace the room anew; else its rays are kept in $XDG_CACHE_HOME/rayloc");
  app.add_flag("--quiet", options->quiet, "no summary on standard error");
  return [options] { return run_replay(*options); };
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
