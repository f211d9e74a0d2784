// `rayloc record`: writes the datagrams of a UDP port,
// an interface or another source to a pcap file.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "capture/source/transport_schemes.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/report/record_report.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/pipeline/record/record_datagrams.h"

namespace rayloc::cli {
namespace {

struct RecordArguments {
  std::string udp;
  std::string interface;
  std::string from;
  SourceOptions options{.filter = "udp port 5500"};
  std::string out;
  DatagramLimits limits;
};

Expected<std::unique_ptr<DatagramSource>> open_source(const RecordArguments& arguments) {
  const int stated = int{!arguments.udp.empty()} + int{!arguments.interface.empty()} +
                     int{!arguments.from.empty()};
  if (stated != 1) {
    return make_error(ErrorKind::kUsage,
                      "state one source: --udp HOST:PORT, --interface IF or --from URL");
  }
  const std::string url = !arguments.udp.empty()         ? "udp:" + arguments.udp
                          : !arguments.interface.empty() ? "live:" + arguments.interface
                                                         : arguments.from;
  auto source = open_datagram_source(transport_schemes(), url, {}, arguments.options);
  if (!source) {
    return source;
  }
  report_source(**source);
  return source;
}

Expected<void> run_record(const RecordArguments& arguments) {
  auto source = open_source(arguments);
  RAYLOC_TRY(source);
  auto recorder = open_datagram_sink(transport_schemes(), arguments.out, "pcap");
  RAYLOC_TRY(recorder);
  StopSignal::install();
  std::fprintf(stderr,
               "rayloc record: %s into %s%s\n",
               (*source)->description().c_str(),
               arguments.out.c_str(),
               arguments.limits.duration || arguments.limits.count ? "" : "; Ctrl-C ends it");
  const auto report = [](const Error& error) {
    std::fprintf(stderr, "rayloc record: %s\n", error.message.c_str());
  };
  auto result =
      record_datagrams(**source, **recorder, arguments.limits, {StopSignal::requested, report});
  if (auto synced = (*recorder)->sync(); result && !synced) {
    result = synced;
  }
  for (const std::string& line : (*source)->warnings()) {
    std::fprintf(stderr, "rayloc record: %s\n", line.c_str());
  }
  report_recorded(**source, **recorder);
  if (result && (*recorder)->counters().lost() > 0) {
    return make_error(ErrorKind::kUnavailable,
                      arguments.out + ": " + std::to_string((*recorder)->counters().lost()) +
                          " datagrams could not be written and are lost");
  }
  return result;
}

RunVerb declare_record(OptionParser& app) {
  auto arguments = std::make_shared<RecordArguments>();
  auto* udp = app.add_option("--udp", arguments->udp, "HOST:PORT to receive at");
  app.add_option("--only-interface",
                 arguments->options.only_interface,
                 "With --udp: only what arrives on this interface")
      ->needs(udp);
  auto* interface = app.add_option("--interface",
                                   arguments->interface,
                                   "Capture what passes an interface (needs CAP_NET_RAW)")
                        ->excludes(udp);
  app.add_option("--filter", arguments->options.filter, "With --interface: a pcap-filter(7)")
      ->needs(interface)
      ->capture_default_str();
  app.add_option(
         "--from",
         arguments->from,
         "Where from, as a URL: " + transport_syntax(transport_schemes(), TransportUse::kSource))
      ->excludes(udp)
      ->excludes(interface);
  app.add_option("--out",
                 arguments->out,
                 "The pcap file to make; it must not exist yet. Or where to send it on: " +
                     transport_syntax(transport_schemes(), TransportUse::kSink))
      ->required();
  app.add_option("--duration", arguments->limits.duration, "Stop after so many seconds")
      ->check(positive());
  app.add_option("--count", arguments->limits.count, "Stop after so many datagrams")
      ->check(positive());
  return [arguments] { return run_record(*arguments); };
}

}  // namespace

extern const Verb kRecord;
const Verb kRecord{"record",
                   "Record the datagrams of an access point",
                   "rayloc record --udp 0.0.0.0:5500 --out ap1.pcap --duration 60",
                   declare_record};

}  // namespace rayloc::cli
