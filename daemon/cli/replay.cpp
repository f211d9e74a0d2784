// `rayloc replay`: a recording through exactly the pipeline that raylocd runs.
#include <cstdint>
#include <cstdio>
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
#include "daemon/arguments/capture_argument.h"
#include "daemon/arguments/time_arguments.h"
#include "daemon/cli/method_arguments.h"
#include "daemon/command/verb.h"
#include "daemon/feed/no_fix_reasons.h"
#include "daemon/methods/method_registry.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/person_estimator.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/playback/paced_source.h"
#include "daemon/pipeline/zone_estimator.h"
#include "daemon/publish/json.h"
#include "daemon/publish/location_message.h"
#include "daemon/publish/target_names.h"
#include "daemon/recordings/replay_report.h"
#include "daemon/scene/scene_notes.h"
#include "daemon/site/path_grid_files.h"
#include "daemon/site/receiver_options.h"
#include "daemon/site/site.h"
#include "daemon/site/site_lacks.h"
#include "daemon/terminal/output_file.h"

namespace rayloc::cli {
namespace {

// Frames of a burst at an access point, a count: more than any access point sends in it.
constexpr std::size_t kEveryFrame = 4096;

struct Options {
  std::string site;
  std::vector<std::string> captures;
  MethodArguments method;
  std::string kind = "all";
  std::string burst = "0.2s";
  std::string speed = "max";
  double max_gap = to_seconds(kMaxGap);
  std::string format = "jsonl";
  std::string out = "-";
  std::string zone_events;  // file; empty: not written
  int threads = 0;
  std::string target_key;  // file; empty: devices are called by their addresses
  double target_rotate_h = 24.0;
  std::optional<double> height_sigma;  // [m]; nothing: those of the site
  ChainKeeper::Options chains;
  std::string snapshots = "always";
  bool no_cache = false;
  bool quiet = false;
};

// What the pipeline reads, and who can tell of it at the end: the pipeline owns them.
struct Recordings {
  std::vector<SourceWorker::Input> inputs;
  std::vector<const RecordedSource*> sources;  // of the inputs, in their order
  std::vector<int> access_points;              // of the inputs, indices in the site
};

Expected<Recordings> open_captures(const Options& options, const Site& site) {
  const auto captures =
      resolve_captures(options.captures, access_point_ids(site), PerAccessPoint::kSeveral);
  if (!captures) {
    return tl::make_unexpected(captures.error());
  }
  const auto speed = parse_speed_argument(options.speed);
  if (!speed) {
    return tl::make_unexpected(speed.error());
  }
  PcapFileOptions file_options;
  file_options.max_gap = from_seconds(options.max_gap);
  const auto pace = *speed ? std::make_shared<Pace>(**speed, file_options.max_gap) : nullptr;
  Recordings all;
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
    if (pace) {
      input.source = std::make_unique<PacedSource>(std::move(input.source), pace);
    }
    input.receiver = receiver_options(site, index);
    all.inputs.push_back(std::move(input));
  }
  return all;
}

// Messages of our own always have a JSON form.
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

// Nothing where they are not to be kept, or nobody knows where.
std::shared_ptr<PathGridStore> path_grids(const Options& options) {
  const auto directory = options.no_cache ? std::nullopt : cache_directory();
  if (!directory) {
    return nullptr;
  }
  PathGridFiles::Options files;
  files.directory = *directory;
  if (!options.quiet) {
    files.log = [](const std::string& line) {
      std::fprintf(stderr, "rayloc replay: cache: %s\n", line.c_str());
    };
  }
  return std::make_shared<PathGridFiles>(std::move(files));
}

Expected<std::shared_ptr<TargetNames>> target_names(const Options& options) {
  TargetNames::Options names;
  if (!options.target_key.empty()) {
    Expected<std::string> key = TargetNames::read_key(options.target_key);
    if (!key) {
      return tl::make_unexpected(key.error());
    }
    names.hashed = true;
    names.key = *std::move(key);
    names.period = from_seconds(3600.0 * options.target_rotate_h);
  }
  return std::make_shared<TargetNames>(std::move(names));
}

// Of the kinds of targets that are asked for.
struct Estimators {
  std::unique_ptr<DeviceEstimator> devices;
  std::unique_ptr<PersonEstimator> people;
  EstimatorList all;
};

Expected<Estimators> make_estimators(const Options& options,
                                     const Site& site,
                                     const Method& method,
                                     const MethodOptions& told) {
  Estimators estimators;
  if (options.kind != "person" && method.create_device != nullptr) {
    DeviceEstimator::Options estimation;
    auto names = target_names(options);
    if (!names) {
      return tl::make_unexpected(names.error());
    }
    estimation.names = *std::move(names);
    estimation.method = &method;
    estimation.settings = told;
    estimation.settings.path_grids = path_grids(options);
    estimation.chains = options.chains;
    estimation.snapshots =
        options.snapshots == "acquire" ? Snapshots::kAcquire : Snapshots::kAlways;
    auto devices = DeviceEstimator::create(site, estimation);
    if (!devices) {
      return tl::make_unexpected(devices.error());
    }
    estimators.devices = *std::move(devices);
    estimators.all.add(*estimators.devices);
  }
  // Without a reference nobody can be seen; who asks for people alone is told so.
  if (options.kind == "person" || estimators.devices == nullptr ||
      (options.kind == "all" && method.create_person != nullptr && site.reference_file)) {
    PersonEstimator::Options estimation;
    estimation.method = &method;
    estimation.settings = told;
    auto people = PersonEstimator::create(site, estimation);
    if (!people) {
      return tl::make_unexpected(people.error());
    }
    estimators.people = *std::move(people);
    estimators.all.add(*estimators.people);
  }
  if (!options.quiet) {
    print_scene_notes(
        *(estimators.devices ? estimators.devices->room() : estimators.people->room()).scene);
  }
  return estimators;
}

Expected<void> write_all(const Options& options,
                         const PipelineOptions& pipeline_options,
                         Recordings recordings,
                         Estimator& estimator) {
  Expected<OutputFile> out = OutputFile::open(options.out);
  if (!out) {
    return tl::make_unexpected(out.error());
  }
  std::optional<OutputFile> events;
  if (!options.zone_events.empty()) {
    Expected<OutputFile> opened = OutputFile::open(options.zone_events);
    if (!opened) {
      return tl::make_unexpected(opened.error());
    }
    events = std::move(*opened);
  }
  NoFixReasons reasons;
  OrderedSink sink(
      [&](const Location& location) {
        reasons.count(location);
        write(location_message(location), options.format, *out);
      },
      [&](const ZoneEvent& event) {
        if (events) {
          write(event_message(event), options.format, *events);
        }
      },
      find_method(options.method.name)->lag);
  Pipeline pipeline(pipeline_options, std::move(recordings.inputs), estimator, sink);
  pipeline.start();
  pipeline.wait();
  sink.finish();
  if (Expected<void> closed = out->close(); !closed) {
    return closed;
  }
  if (events) {
    if (Expected<void> closed = events->close(); !closed) {
      return closed;
    }
  }
  Expected<void> reported = report_replay(pipeline, recordings.sources, options.quiet);
  if (const std::string text = reasons.text(); !text.empty() && !options.quiet) {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
  return reported;
}

// What the site lacks to locate what is asked for, by the access points that were recorded.
void report_lacks(const Options& options,
                  const Site& site,
                  const Estimators& estimators,
                  const std::vector<int>& heard) {
  if (options.quiet || !estimators.devices) {  // of people alone each estimate says so
    return;
  }
  const SiteLacks lacks = site_lacks(site, estimators.devices->room(), heard);
  for (const std::string& lack : options.kind == "all" ? lacks.all() : lacks.obstacles) {
    std::fprintf(stderr, "rayloc replay: %s\n", lack.c_str());
  }
}

// Of all devices, also of those that state their own.
void assume_height_sigma(double sigma, Site& site) {
  site.targets.height_sigma = sigma;
  for (SiteTransmitter& transmitter : site.transmitters) {
    transmitter.height_sigma = sigma;
  }
}

Expected<void> run(const Options& options) {
  const Method& method = *find_method(options.method.name);
  if (auto checked = check_targets(method, options.kind); !checked) {
    return checked;
  }
  auto told = method_options(options.method);
  if (!told) {
    return tl::make_unexpected(std::move(told.error()));
  }
  const Expected<Duration> burst = parse_burst_argument(options.burst);
  if (!burst) {
    return tl::make_unexpected(burst.error());
  }
  Expected<Site> site = load_site(options.site);
  if (!site) {
    return tl::make_unexpected(site.error());
  }
  if (options.height_sigma) {
    assume_height_sigma(*options.height_sigma, *site);
  }
  // Of the engine's parallel loops; the results are the same for any number.
  const oneapi::tbb::global_control threads(
      oneapi::tbb::global_control::max_allowed_parallelism,
      static_cast<std::size_t>(options.threads > 0 ? options.threads
                                                   : oneapi::tbb::info::default_concurrency()));
  auto recordings = open_captures(options, *site);
  if (!recordings) {
    return tl::make_unexpected(recordings.error());
  }
  auto estimators = make_estimators(options, *site, method, *told);
  if (!estimators) {
    return tl::make_unexpected(estimators.error());
  }
  PipelineOptions pipeline_options;
  pipeline_options.burst.length = *burst;
  pipeline_options.overflow = Overflow::kWait;
  if (method.needs_every_frame) {
    pipeline_options.burst.max_frames = kEveryFrame;
  }
  ZoneEstimator zones(estimators->all, site->zones);
  const std::vector<int> heard = recordings->access_points;
  Expected<void> written = write_all(options, pipeline_options, std::move(*recordings), zones);
  if (estimators->devices && !options.quiet) {
    for (const std::string& line : estimators->devices->chain_news()) {
      std::fprintf(stderr, "rayloc replay: %s\n", line.c_str());
    }
  }
  report_lacks(options, *site, *estimators, heard);
  return written;
}

RunVerb declare(OptionParser& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("site", options->site, "directory with site.toml")->required();
  app.add_option("captures",
                 options->captures,
                 "[AP=]FILE: pcap, pcapng, .gz, the .dat log of an Intel 5300, or - for stdin; "
                 "several of one AP are a sequence in "
                 "order of time")
      ->required();
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
                 "file for who enters and leaves the zones of the site, one ZoneEvent a line");
  app.add_option("--height-sigma",
                 options->height_sigma,
                 "standard deviation of the devices' heights [m], instead of the site's "
                 "height_sigma_m; 0: they are known")
      ->check(in_range(kHeightSigmaRange.min, kHeightSigmaRange.max));
  app.add_option("--threads", options->threads, "of the engine; 0 takes one per core")
      ->check(in_range(0, 1024))
      ->capture_default_str();
  app.add_option("--target-key",
                 options->target_key,
                 "hash devices' addresses as raylocd does with this [privacy] key_file");
  app.add_option("--target-rotate-h", options->target_rotate_h, "its rotate_h")
      ->check(in_range(0.01, 8760.0))
      ->capture_default_str();
  app.add_option("--chains", options->chains.read, "file with what was learned of chains before");
  app.add_option("--chains-out", options->chains.write, "file for what is learned of them");
  app.add_option("--snapshots",
                 options->snapshots,
                 "a burst as a whole, anywhere in the room: of every burst (always), or of devices "
                 "that no track follows yet (acquire)")
      ->check(one_of({"always", "acquire"}))
      ->capture_default_str();
  app.add_flag("--no-cache",
               options->no_cache,
               "trace the room anew; else its rays are kept in $XDG_CACHE_HOME/rayloc");
  app.add_flag("--quiet", options->quiet, "no summary on standard error");
  return [options] { return run(*options); };
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
    "  rayloc replay room-people/ ap1=monday.pcap --kind person --burst 1.2s\n"
    "  rayloc replay room-people/ ap1=monday.pcap --kind person --method paper --seed 7",
    &declare};

}  // namespace rayloc::cli
