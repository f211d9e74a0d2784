// `rayloc replay`: a recording through exactly the pipeline that raylocd runs.
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/delimited_message_util.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include "capture/pcap_source.h"
#include "daemon/cli/capture_argument.h"
#include "daemon/cli/output_file.h"
#include "daemon/cli/verb.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/ordered_sink.h"
#include "daemon/pipeline/paced_source.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/publish/json.h"
#include "daemon/site/site.h"

namespace rayloc::cli {
namespace {

struct Options {
  std::string site;
  std::vector<std::string> captures;
  std::string method = "rayloc";
  std::string kind = "all";
  std::string burst = "0.2s";
  std::string speed = "max";
  std::string format = "jsonl";
  std::string out = "-";
  std::uint64_t seed = 1;
  std::size_t starts = 1;
  int threads = 0;
  bool quiet = false;
};

struct Quantity {
  double value = 0.0;
  std::string unit;
};

// Nothing when `text` does not begin with a number.
std::optional<Quantity> parse_quantity(const std::string& text) {
  Quantity quantity;
  const auto [end, status] =
      std::from_chars(text.data(), text.data() + text.size(), quantity.value);
  if (status != std::errc()) {
    return std::nullopt;
  }
  quantity.unit.assign(end, text.data() + text.size());
  return quantity;
}

// "0.2s", "200ms" or plain seconds.
Expected<Duration> parse_burst(const std::string& text) {
  const std::optional<Quantity> burst = parse_quantity(text);
  if (burst && (burst->unit.empty() || burst->unit == "s" || burst->unit == "ms")) {
    const double seconds = burst->value * (burst->unit == "ms" ? 1e-3 : 1.0);
    if (seconds >= 1e-3 && seconds <= 60.0) {
      return from_seconds(seconds);
    }
  }
  return make_error(
      ErrorKind::kUsage,
      "--burst " + text + ": write a duration from 1ms to 60s, for example 0.2s or 500ms");
}

// Nothing for "max".
Expected<std::optional<double>> parse_speed(const std::string& text) {
  if (text == "max") {
    return std::optional<double>();
  }
  const std::optional<Quantity> speed = parse_quantity(text);
  if (!speed || !speed->unit.empty() || !(speed->value > 0.0) || speed->value > 1e6) {
    return make_error(ErrorKind::kUsage,
                      "--speed " + text + ": write max, or how many times faster than recorded: 1");
  }
  return std::optional<double>(speed->value);
}

Expected<std::vector<SourceWorker::Input>> open_captures(const Options& options, const Site& site) {
  std::vector<std::string> ids;
  for (const SiteAccessPoint& access_point : site.access_points) {
    ids.push_back(access_point.id);
  }
  const auto captures = resolve_captures(options.captures, ids);
  if (!captures) {
    return tl::make_unexpected(captures.error());
  }
  const auto speed = parse_speed(options.speed);
  if (!speed) {
    return tl::make_unexpected(speed.error());
  }
  const auto pace = *speed ? std::make_shared<Pace>(**speed) : nullptr;
  std::vector<SourceWorker::Input> inputs;
  for (const CaptureArgument& capture : *captures) {
    Expected<std::unique_ptr<PcapFileSource>> file = PcapFileSource::open(capture.file);
    if (!file) {
      return tl::make_unexpected(file.error());
    }
    const int index = *find_access_point(site, capture.access_point);
    const SiteAccessPoint& access_point = site.access_points[static_cast<std::size_t>(index)];
    SourceWorker::Input input;
    input.access_point = capture.access_point;
    input.source = std::move(*file);
    if (pace) {
      input.source = std::make_unique<PacedSource>(std::move(input.source), pace);
    }
    input.receiver.access_point = index;
    input.receiver.format = access_point.format;
    input.receiver.expected_cores = access_point.cores;
    inputs.push_back(std::move(input));
  }
  return inputs;
}

// Locations of our own always have a JSON form.
void write_location(const v1::Location& location, const std::string& format, OutputFile& out) {
  if (format == "pb") {
    std::string bytes;
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::util::SerializeDelimitedToZeroCopyStream(location, &stream);
    out.write(bytes);
  } else {
    out.write(to_json(location).value() + "\n");
  }
}

// What was read and what became of it, and every source that ended before its time.
Expected<void> report(const Pipeline& pipeline, bool quiet) {
  const EstimationCounters counters = pipeline.estimation_counters();
  std::string failed;
  for (const SourceReport& source : pipeline.source_reports()) {
    std::uint64_t rejected = 0;
    for (const auto& [reason, count] : source.source.rejected) {
      rejected += count;
    }
    for (const auto& [reason, count] : source.receiver.rejected) {
      rejected += count;
    }
    if (!quiet) {
      std::fprintf(stderr,
                   "%s: %s: %llu packets, %llu rejected, %llu frames (%llu partial)\n",
                   source.access_point.c_str(),
                   source.description.c_str(),
                   static_cast<unsigned long long>(source.source.received),
                   static_cast<unsigned long long>(rejected),
                   static_cast<unsigned long long>(source.receiver.frames),
                   static_cast<unsigned long long>(source.receiver.partial));
    }
    if (!source.error.empty()) {
      failed += (failed.empty() ? "" : "\n") + source.error;
    }
  }
  if (!quiet) {
    std::fprintf(stderr,
                 "%llu bursts, %llu locations, %llu of them without a fix\n",
                 static_cast<unsigned long long>(counters.bursts),
                 static_cast<unsigned long long>(counters.locations),
                 static_cast<unsigned long long>(counters.no_fix));
  }
  if (!failed.empty()) {
    return bad_input(failed);
  }
  return {};
}

Expected<void> run(const Options& options) {
  if (options.kind == "person") {
    return make_error(ErrorKind::kUsage,
                      "--kind person: this version locates devices only; use --kind device");
  }
  if (options.starts > 1 && options.method != "paper") {
    return make_error(ErrorKind::kUsage,
                      "--multi-start: method " + options.method +
                          " starts nowhere; use --method "
                          "paper");
  }
  const Expected<Duration> burst = parse_burst(options.burst);
  if (!burst) {
    return tl::make_unexpected(burst.error());
  }
  const Expected<Site> site = load_site(options.site);
  if (!site) {
    return tl::make_unexpected(site.error());
  }
  // Of the engine's parallel loops; the results are the same for any number.
  const oneapi::tbb::global_control threads(
      oneapi::tbb::global_control::max_allowed_parallelism,
      static_cast<std::size_t>(options.threads > 0 ? options.threads
                                                   : oneapi::tbb::info::default_concurrency()));
  Expected<std::vector<SourceWorker::Input>> inputs = open_captures(options, *site);
  if (!inputs) {
    return tl::make_unexpected(inputs.error());
  }
  DeviceEstimator::Options estimation;
  estimation.method = options.method == "paper" ? LocationMethod::kPaper : LocationMethod::kRayloc;
  estimation.paper.seed = options.seed;
  estimation.paper.starts = options.starts;
  Expected<std::unique_ptr<DeviceEstimator>> estimator = DeviceEstimator::create(*site, estimation);
  if (!estimator) {
    return tl::make_unexpected(estimator.error());
  }
  Expected<OutputFile> out = OutputFile::open(options.out);
  if (!out) {
    return tl::make_unexpected(out.error());
  }
  OrderedSink sink(
      [&](const v1::Location& location) { write_location(location, options.format, *out); });
  PipelineOptions pipeline_options;
  pipeline_options.burst.length = *burst;
  pipeline_options.overflow = Overflow::kWait;
  Pipeline pipeline(pipeline_options, std::move(*inputs), **estimator, sink);
  pipeline.start();
  pipeline.wait();
  sink.finish();
  if (Expected<void> closed = out->close(); !closed) {
    return closed;
  }
  return report(pipeline, options.quiet);
}

RunVerb declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("site", options->site, "directory with site.toml")->required();
  app.add_option("captures", options->captures, "[AP=]FILE: pcap, pcapng, .gz, or - for stdin")
      ->required();
  app.add_option("--method", options->method, "rayloc, or paper: the published one, as it is")
      ->check(CLI::IsMember({"rayloc", "paper"}))
      ->capture_default_str();
  app.add_option("--kind", options->kind, "targets to locate")
      ->check(CLI::IsMember({"device", "person", "all"}))
      ->capture_default_str();
  app.add_option("--burst", options->burst, "length of a burst of frames")->capture_default_str();
  app.add_option("--speed", options->speed, "max, or N times the recorded pace")
      ->capture_default_str();
  app.add_option("--format", options->format, "jsonl, or varint-delimited protobuf")
      ->check(CLI::IsMember({"jsonl", "pb"}))
      ->capture_default_str();
  app.add_option("--out", options->out, "file to write instead of standard output");
  app.add_option("--seed", options->seed, "of random numbers; rayloc draws none")
      ->capture_default_str();
  app.add_option("--multi-start", options->starts, "random starts of paper; the least loss wins")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  app.add_option("--threads", options->threads, "of the engine; 0 takes one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_flag("--quiet", options->quiet, "no summary on standard error");
  return [options] { return run(*options); };
}

}  // namespace

extern const Verb kReplay;
const Verb kReplay = {
    "replay",
    "Locate targets in recordings, as raylocd would have",
    "rayloc replay room/ ap1=monday.pcap ap2=monday-2.pcap.gz > locations.jsonl\n"
    "  rayloc replay room/ ap1=monday.pcap --method paper --multi-start 8 --seed 7",
    &declare};

}  // namespace rayloc::cli
