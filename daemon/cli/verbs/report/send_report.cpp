#include "daemon/cli/verbs/report/send_report.h"

#include <cstdio>
#include <optional>

#include <nlohmann/json.hpp>

#include "capture/source/recording_plan.h"

namespace rayloc::cli {
namespace {

void print_send_object(const nlohmann::ordered_json& object) {
  std::printf("%s\n", object.dump().c_str());
  std::fflush(stdout);
}

nlohmann::ordered_json offset_json(std::optional<Duration> time_offset) {
  nlohmann::ordered_json offset = nullptr;
  if (time_offset) {
    offset = to_seconds(*time_offset);
  }
  return offset;
}

void announce_start(std::optional<Duration> time_offset,
                    const std::vector<std::string>& destinations) {
  nlohmann::ordered_json line;
  line["event"] = "start";
  line["time_offset_s"] = offset_json(time_offset);
  if (time_offset) {
    std::fprintf(stderr,
                 "rayloc send: time offset %.6f s (wall clock - recording)\n",
                 to_seconds(*time_offset));
  }
  line["to"] = destinations;
  print_send_object(line);
}

void announce_skipped(Duration gap, Duration skipped, std::optional<Duration> time_offset) {
  nlohmann::ordered_json line;
  line["event"] = "gap";
  line["gap_s"] = to_seconds(gap);
  line["skipped_s"] = to_seconds(skipped);
  line["time_offset_s"] = offset_json(time_offset);
  print_send_object(line);
  std::fprintf(stderr,
               "rayloc send: a gap of %.1f s in the recording, of which %.1f s are waited for (see "
               "--max-gap)\n",
               to_seconds(gap),
               to_seconds(gap - skipped));
}

}  // namespace

void print_send_lines(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    std::fprintf(stderr, "rayloc send: %s\n", line.c_str());
  }
}

SendObserver send_events(const std::vector<std::string>& destinations) {
  SendObserver observer;
  observer.on_start = [destinations](std::optional<Duration> time_offset) {
    announce_start(time_offset, destinations);
  };
  observer.on_gap = announce_skipped;
  return observer;
}

void print_sent(const SinkCounters& sent,
                const SendOutcome& outcome,
                const std::map<std::string, std::uint64_t>& rejected) {
  const double elapsed = to_seconds(outcome.elapsed);
  const double rate = elapsed > 0 ? static_cast<double>(sent.delivered) / elapsed : 0;
  nlohmann::ordered_json line;
  line["event"] = "end";
  line["datagrams"] = sent.delivered;
  line["bytes"] = sent.bytes;
  line["elapsed_s"] = elapsed;
  line["rate_hz"] = rate;
  line["late_max_s"] = to_seconds(outcome.latest);
  line["rejected"] = rejected;
  if (sent.lost() > 0) {
    line["lost"] = sent.lost_by;
  }
  print_send_object(line);
  std::fprintf(stderr,
               "rayloc send: sent %llu datagrams in %.3f s (%.1f/s, at most %.1f ms late)\n",
               static_cast<unsigned long long>(sent.delivered),  // NOLINT(google-runtime-int)
               elapsed,
               rate,
               to_seconds(outcome.latest) * 1e3);
  if (const std::string reasons = rejections_text(rejected); !reasons.empty()) {
    std::fprintf(stderr, "rayloc send: packets rejected: %s\n", reasons.c_str());
  }
  if (const std::string reasons = rejections_text(sent.lost_by); !reasons.empty()) {
    std::fprintf(stderr, "rayloc send: not delivered: %s\n", reasons.c_str());
  }
}

}  // namespace rayloc::cli
