// `rayloc send`: sends a recording's datagrams to a
// UDP port or another sink, as the access point would.
#include <sys/prctl.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/source/transport_schemes.h"
#include "capture/transport/sink_queue.h"
#include "daemon/cli/arguments/time_arguments.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/report/send_report.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/open_recording.h"
#include "daemon/pipeline/playback/merged_recordings.h"
#include "daemon/pipeline/playback/recording_sender.h"

namespace rayloc::cli {
namespace {

struct SendArguments {
  std::vector<std::string> files;
  std::vector<std::string> destinations;
  std::string speed = "1";
  std::optional<double> rate;      // datagrams per second, instead of the recorded times
  std::optional<double> duration;  // seconds
  double max_gap = to_seconds(kMaxGap);
};

Expected<std::vector<std::unique_ptr<DatagramSource>>> open_recordings(
    const std::vector<RecordingArgument>& recordings, const SourceOptions& options) {
  std::vector<std::unique_ptr<DatagramSource>> sources;
  for (const RecordingArgument& recording : recordings) {
    auto source = open_recording(recording, options);
    RAYLOC_TRY(source);
    print_send_lines((*source)->notices());
    sources.push_back(*std::move(source));
  }
  return sources;
}

Expected<std::vector<std::unique_ptr<DatagramSink>>> open_sinks(
    const std::vector<std::string>& destinations) {
  std::vector<std::unique_ptr<DatagramSink>> sinks;
  for (const std::string& text : destinations) {
    auto sink = open_datagram_sink(transport_schemes(), text, "udp");
    RAYLOC_TRY(sink);
    sinks.push_back(*std::move(sink));
  }
  return sinks;
}

Expected<void> run_send(const SendArguments& arguments) {
  const auto speed = parse_pace_argument(arguments.speed);
  RAYLOC_TRY(speed);
  const std::vector<RecordingArgument> captures = recordings_of_any(arguments.files);
  if (captures.size() != arguments.destinations.size()) {
    return make_error(ErrorKind::kUsage,
                      std::to_string(captures.size()) + " recordings and " +
                          std::to_string(arguments.destinations.size()) +
                          " destinations; give one --to for each, in the same order (files of one "
                          "access point are one recording: AP=FILE AP=FILE)");
  }
  auto sinks = open_sinks(arguments.destinations);
  RAYLOC_TRY(sinks);
  SourceOptions options;
  options.max_gap = from_seconds(arguments.max_gap);
  auto sources = open_recordings(captures, options);
  RAYLOC_TRY(sources);
  MergedRecordings recordings(*std::move(sources), StopSignal::requested);
  SinkQueue queue(*std::move(sinks));
  StopSignal::install();
  prctl(PR_SET_TIMERSLACK, 1);  // wake up on time, not 50 us later
  RecordingSender sender(
      recordings, queue, send_events(arguments.destinations), StopSignal::requested);
  const auto outcome = arguments.rate
                           ? sender.send_at_rate(*arguments.rate, arguments.duration)
                           : sender.send_paced({.speed = *speed,
                                                .duration = arguments.duration,
                                                .max_gap = from_seconds(arguments.max_gap)});
  RAYLOC_TRY(outcome);
  const auto synced = queue.sync();
  print_send_lines(recordings.warnings());
  print_sent(queue.counters(), *outcome, recordings.rejected());
  return synced;
}

RunVerb declare_send(OptionParser& app) {
  auto arguments = std::make_shared<SendArguments>();
  app.add_option("FILE",
                 arguments->files,
                 "Recordings: [AP=]FILE, pcap, pcapng, .gz, or - for standard input. Several of "
                 "one AP are a sequence in order of time")
      ->required();
  app.add_option("--to",
                 arguments->destinations,
                 "HOST:PORT, or " + transport_syntax(transport_schemes(), TransportUse::kSink) +
                     "; one for each recording (or AP), in the order of the first files")
      ->required()
      ->allow_extra_args(false);
  auto* speed = app.add_option("--speed",
                               arguments->speed,
                               "Times the recorded pace, or max (a receiver may lose datagrams)")
                    ->capture_default_str();
  app.add_option("--rate",
                 arguments->rate,
                 "Datagrams per second instead of the recorded pace. With --duration the recording "
                 "is repeated, frame counters and all")
      ->check(positive())
      ->excludes(speed);
  app.add_option("--max-gap",
                 arguments->max_gap,
                 "Seconds of the recording that are waited at most where it holds nothing, or the "
                 "clock was set")
      ->check(in_range(0.1, 1e9))
      ->capture_default_str();
  app.add_option("--duration", arguments->duration, "Stop after so many seconds")
      ->check(positive());
  return [arguments] { return run_send(*arguments); };
}

}  // namespace

extern const Verb kSend;
const Verb kSend{"send",
                 "Send a recording to a UDP port, as the access point would",
                 "rayloc send ap1.pcap ap2.pcap --to 127.0.0.1:5500 --to 127.0.0.1:5501\n"
                 "  rayloc send ap1=ring.pcap0 ap1=ring.pcap1 --to 127.0.0.1:5500",
                 declare_send};

}  // namespace rayloc::cli
