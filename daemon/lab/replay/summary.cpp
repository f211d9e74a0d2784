#include "daemon/lab/replay/summary.h"

#include <map>

#include "daemon/lab/recordings/recorded_frames.h"

namespace rayloc::replay {
namespace {

std::uint64_t sum_of(const std::map<std::string, std::uint64_t>& counts) {
  std::uint64_t sum = 0;
  for (const auto& [reason, count] : counts) {
    sum += count;
  }
  return sum;
}

ReplayedSource replayed_source(const SourceReport& report, const RecordedSource& recording) {
  ReplayedSource source;
  source.access_point = report.access_point;
  source.description = report.description;
  source.packets = report.source.received;
  source.rejected = sum_of(report.source.rejected) + sum_of(report.receiver.rejected);
  source.frames = report.receiver.frames;
  source.partial = report.receiver.partial;
  note_recording(recording, report.receiver, report.access_point, source.notes);
  if (!report.stamps.empty()) {
    source.notes.push_back(report.access_point + ": " + report.description + ": " + report.stamps);
  }
  source.error = report.error;
  return source;
}

// Empty where a source ended prematurely: that is the reason then.
std::string reason_of_no_frames(const std::vector<SourceReport>& sources) {
  std::uint64_t received = 0;
  std::uint64_t frames = 0;
  bool is_rejected = false;  // CSI was recognised
  std::uint64_t of_no_device = 0;
  bool is_complete = true;
  for (const SourceReport& source : sources) {
    received += source.source.received;
    frames += source.receiver.frames;
    is_rejected = is_rejected || !source.receiver.troubles.empty();
    of_no_device += addresses_refused(source.receiver);
    is_complete = is_complete && source.error.empty();
  }
  if (!is_complete || received == 0 || frames > 0) {
    return "";
  }
  const char* const what = is_rejected        ? "the CSI was rejected of "
                           : of_no_device > 0 ? "no frame of a device in "
                                              : "no CSI in ";
  return what + std::to_string(received) + " packets";
}

}  // namespace

Summary summarize(const Pipeline& pipeline, const std::vector<const RecordedSource*>& recordings) {
  Summary summary;
  const std::vector<SourceReport> reports = pipeline.source_reports();
  for (std::size_t i = 0; i < reports.size(); ++i) {
    summary.sources.push_back(replayed_source(reports[i], *recordings[i]));
  }
  summary.counters = pipeline.estimation_counters();
  summary.no_frames = reason_of_no_frames(reports);
  return summary;
}

}  // namespace rayloc::replay
