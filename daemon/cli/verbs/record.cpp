// `rayloc record`: writes the datagrams of a UDP port,
// an interface or another source to a pcap file.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "capture/source/recording_plan.h"
#include "capture/source/rejection_words.h"
#include "capture/source/transport_schemes.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

using RecordingClock = std::chrono::steady_clock;

struct RecordArguments {
  std::string udp;
  std::string interface;
  std::string from;
  SourceOptions options{.filter = "udp port 5500"};
  std::string out;
  std::optional<double> duration;      // seconds
  std::optional<std::uint64_t> count;  // datagrams
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
  for (const std::string& line : (*source)->notices()) {
    std::fprintf(stderr, "rayloc record: %s\n", line.c_str());
  }
  const ReceiveBuffer buffer = (*source)->receive_buffer();
  if (buffer.granted_bytes < buffer.wanted_bytes) {
    std::fprintf(stderr,
                 "rayloc record: the receive buffer is %d KiB instead of %d; to lose nothing at "
                 "high rates: sysctl net.core.rmem_max=%d\n",
                 buffer.granted_bytes / 1024,
                 buffer.wanted_bytes / 1024,
                 buffer.wanted_bytes);
  }
  return source;
}

// Reports that datagrams could not be written: at once, then every ten seconds meanwhile.
class WriteErrors {
 public:
  void report(const Error& error) {
    const auto now = RecordingClock::now();
    if (!reported_ || now - *reported_ > std::chrono::seconds(10)) {
      reported_ = now;
      std::fprintf(stderr, "rayloc record: %s\n", error.message.c_str());
    }
  }

 private:
  std::optional<RecordingClock::time_point> reported_;
};

// An Error of the source ends the recording; one of the file does not: space may become free.
Expected<void> record(DatagramSource& source,
                      DatagramSink& recorder,
                      const RecordArguments& arguments) {
  constexpr Duration kTick = std::chrono::milliseconds(100);
  const auto begin = RecordingClock::now();
  const std::uint64_t limit = arguments.count.value_or(UINT64_MAX);
  DatagramBatch batch;
  WriteErrors errors;
  while (!StopSignal::requested() && !batch.ended && recorder.counters().given < limit) {
    Duration wait = kTick;
    if (arguments.duration) {
      const Duration left = from_seconds(*arguments.duration) - (RecordingClock::now() - begin);
      if (left <= Duration::zero()) {
        break;
      }
      wait = std::min(wait, left);
    }
    if (auto read = source.read(batch, wait); !read) {
      return read;
    }
    const std::uint64_t room = limit - recorder.counters().given;
    const auto taken = std::min<std::uint64_t>(room, batch.datagrams.size());
    batch.datagrams.resize(taken);
    recorder.note_source(source.counters());
    if (auto written = recorder.write(batch); !written) {
      errors.report(written.error());
    }
  }
  return {};
}

void report_recorded(const DatagramSource& source, const DatagramSink& recorder) {
  const SourceCounters from = source.counters();
  const SinkCounters& to = recorder.counters();
  nlohmann::ordered_json summary;
  summary["received"] = from.received;
  summary["rejected"] = from.rejected;
  summary["kernel_drops"] = from.kernel_drops;
  summary["recorded"] = to.delivered;
  summary["lost"] = to.lost();
  // Datagrams of the last batch beyond --count.
  summary["surplus"] = from.delivered - to.given;
  summary["file_bytes"] = to.bytes;
  nlohmann::ordered_json line;
  line["summary"] = summary;
  std::printf("%s\n", line.dump().c_str());
  if (const std::string reasons = rejections_text(from.rejected); !reasons.empty()) {
    std::fprintf(stderr, "rayloc record: packets rejected: %s\n", reasons.c_str());
  }
  for (const std::string& words : rejection_words(from, source.description())) {
    std::fprintf(stderr, "rayloc record: %s\n", words.c_str());
  }
}

Expected<void> run_record(const RecordArguments& arguments) {
  auto source = open_source(arguments);
  if (!source) {
    return tl::make_unexpected(std::move(source.error()));
  }
  auto recorder = open_datagram_sink(transport_schemes(), arguments.out, "pcap");
  if (!recorder) {
    return tl::make_unexpected(std::move(recorder.error()));
  }
  StopSignal::install();
  std::fprintf(stderr,
               "rayloc record: %s into %s%s\n",
               (*source)->description().c_str(),
               arguments.out.c_str(),
               arguments.duration || arguments.count ? "" : "; Ctrl-C ends it");
  auto result = record(**source, **recorder, arguments);
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
  app.add_option("--duration", arguments->duration, "Stop after so many seconds")
      ->check(positive());
  app.add_option("--count", arguments->count, "Stop after so many datagrams")->check(positive());
  return [arguments] { return run_record(*arguments); };
}

}  // namespace

extern const Verb kRecord;
const Verb kRecord{"record",
                   "Record the datagrams of an access point",
                   "rayloc record --udp 0.0.0.0:5500 --out ap1.pcap --duration 60",
                   declare_record};

}  // namespace rayloc::cli
