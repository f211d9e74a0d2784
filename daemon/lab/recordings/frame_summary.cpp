#include "daemon/lab/recordings/frame_summary.h"

#include <nlohmann/json.hpp>

namespace rayloc {

void FrameSummary::add(const SourceCounters& source, const CsiReceiverCounters& receiver) {
  datagrams += source.received;
  decoded += receiver.in_frames + receiver.duplicates + receiver.late;
  duplicates += receiver.duplicates;
  late += receiver.late;
  frames += receiver.frames;
  partial += receiver.partial;
  unrecorded += source.unrecorded;
  for (const auto& counts : {source.rejected, receiver.rejected}) {
    for (const auto& [reason, count] : counts) {
      rejected[reason] += count;
    }
  }
}

std::string summary_json(const FrameSummary& summary) {
  return nlohmann::ordered_json{{"summary",
                                 {{"datagrams", summary.datagrams},
                                  {"decoded", summary.decoded},
                                  {"duplicates", summary.duplicates},
                                  {"late", summary.late},
                                  {"frames", summary.frames},
                                  {"partial", summary.partial},
                                  {"unrecorded", summary.unrecorded},
                                  {"rejected", summary.rejected}}}}
      .dump();
}

std::string summary_text(const FrameSummary& summary) {
  std::string line = std::to_string(summary.datagrams) + " datagrams, " +
                     std::to_string(summary.decoded) + " decoded (" +
                     std::to_string(summary.duplicates) + " duplicates, " +
                     std::to_string(summary.late) + " late), " + std::to_string(summary.frames) +
                     " frames, " + std::to_string(summary.partial) + " partial";
  for (const auto& [reason, count] : summary.rejected) {
    line += ", " + std::to_string(count) + " rejected: " + reason;
  }
  if (summary.unrecorded > 0) {
    line += "; marked in the recording as not recorded: " + std::to_string(summary.unrecorded);
  }
  return line;
}

}  // namespace rayloc
