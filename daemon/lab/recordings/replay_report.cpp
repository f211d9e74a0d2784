#include "daemon/lab/recordings/replay_report.h"

#include <cstdint>
#include <cstdio>
#include <map>
#include <string>

#include "daemon/lab/recordings/recorded_frames.h"

namespace rayloc::cli {
namespace {

std::uint64_t sum_of(const std::map<std::string, std::uint64_t>& counts) {
  std::uint64_t sum = 0;
  for (const auto& [reason, count] : counts) {
    sum += count;
  }
  return sum;
}

void report_source(const SourceReport& source, const std::vector<std::string>& notes) {
  const std::uint64_t rejected = sum_of(source.source.rejected) + sum_of(source.receiver.rejected);
  std::fprintf(stderr,
               "%s: %s: %llu packets, %llu rejected, %llu frames (%llu partial)\n",
               source.access_point.c_str(),
               source.description.c_str(),
               static_cast<unsigned long long>(source.source.received),
               static_cast<unsigned long long>(rejected),
               static_cast<unsigned long long>(source.receiver.frames),
               static_cast<unsigned long long>(source.receiver.partial));
  for (const std::string& note : notes) {
    std::fprintf(stderr, "%s\n", note.c_str());
  }
}

}  // namespace

Expected<void> report_replay(const Pipeline& pipeline,
                             const std::vector<const RecordedSource*>& recordings,
                             bool quiet) {
  const EstimationCounters counters = pipeline.estimation_counters();
  std::string failed;
  std::string without_csi;
  std::uint64_t received = 0;
  std::uint64_t frames = 0;
  bool is_rejected = false;  // CSI was recognised
  std::uint64_t of_no_device = 0;
  const std::vector<SourceReport> sources = pipeline.source_reports();
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const SourceReport& source = sources[i];
    std::vector<std::string> notes;
    note_recording(*recordings[i], source.receiver, source.access_point, notes);
    if (!source.stamps.empty()) {
      notes.push_back(source.access_point + ": " + source.description + ": " + source.stamps);
    }
    if (!quiet) {
      report_source(source, notes);
    }
    for (const std::string& note : quiet ? notes : std::vector<std::string>()) {
      without_csi += "\n" + note;
    }
    received += source.source.received;
    frames += source.receiver.frames;
    is_rejected = is_rejected || !source.receiver.troubles.empty();
    of_no_device += addresses_refused(source.receiver);
    if (!source.error.empty()) {
      failed += (failed.empty() ? "" : "\n") + source.error;
    }
  }
  if (failed.empty() && received > 0 && frames == 0) {
    const char* const what = is_rejected        ? "the CSI was rejected of "
                             : of_no_device > 0 ? "no frame of a device in "
                                                : "no CSI in ";
    return bad_input(what + std::to_string(received) + " packets" + without_csi);
  }
  if (!quiet) {
    std::fprintf(
        stderr,
        "%llu bursts, %llu snapshots, %llu of them without a fix, %llu filtered estimates\n",
        static_cast<unsigned long long>(counters.bursts),
        static_cast<unsigned long long>(counters.snapshots),
        static_cast<unsigned long long>(counters.no_fix),
        static_cast<unsigned long long>(counters.filtered));
  }
  if (!failed.empty()) {
    return bad_input(failed);
  }
  return {};
}

}  // namespace rayloc::cli
