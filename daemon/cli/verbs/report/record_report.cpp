#include "daemon/cli/verbs/report/record_report.h"

#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include "capture/source/recording_plan.h"
#include "capture/source/rejection_words.h"

namespace rayloc::cli {

void report_source(const DatagramSource& source) {
  for (const std::string& line : source.notices()) {
    std::fprintf(stderr, "rayloc record: %s\n", line.c_str());
  }
  const ReceiveBuffer buffer = source.receive_buffer();
  if (buffer.granted_bytes < buffer.wanted_bytes) {
    std::fprintf(stderr,
                 "rayloc record: the receive buffer is %d KiB instead of %d; to lose nothing at "
                 "high rates: sysctl net.core.rmem_max=%d\n",
                 buffer.granted_bytes / 1024,
                 buffer.wanted_bytes / 1024,
                 buffer.wanted_bytes);
  }
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

}  // namespace rayloc::cli
