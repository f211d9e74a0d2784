#include "daemon/cli/verbs/report/replay_report.h"

#include <cstdio>

namespace rayloc::cli {
namespace {

void print_replayed_source(const replay::ReplayedSource& source) {
  std::fprintf(stderr,
               "%s: %s: %llu packets, %llu rejected, %llu frames (%llu partial)\n",
               source.access_point.c_str(),
               source.description.c_str(),
               static_cast<unsigned long long>(source.packets),
               static_cast<unsigned long long>(source.rejected),
               static_cast<unsigned long long>(source.frames),
               static_cast<unsigned long long>(source.partial));
  for (const std::string& note : source.notes) {
    std::fprintf(stderr, "%s\n", note.c_str());
  }
}

void print_replay_counters(const EstimationCounters& counters) {
  std::fprintf(stderr,
               "%llu bursts, %llu snapshots, %llu of them without a fix, %llu filtered estimates\n",
               static_cast<unsigned long long>(counters.bursts),
               static_cast<unsigned long long>(counters.snapshots),
               static_cast<unsigned long long>(counters.no_fix),
               static_cast<unsigned long long>(counters.filtered));
}

Expected<void> report_sources(const replay::Summary& summary, bool quiet) {
  std::string failed;
  std::string unprinted;
  for (const replay::ReplayedSource& source : summary.sources) {
    if (!quiet) {
      print_replayed_source(source);
    }
    for (const std::string& note : quiet ? source.notes : std::vector<std::string>()) {
      unprinted += "\n" + note;
    }
    if (!source.error.empty()) {
      failed += (failed.empty() ? "" : "\n") + source.error;
    }
  }
  if (!summary.no_frames.empty()) {
    return bad_input(summary.no_frames + unprinted);
  }
  if (!quiet) {
    print_replay_counters(summary.counters);
  }
  if (!failed.empty()) {
    return bad_input(failed);
  }
  return {};
}

}  // namespace

Expected<void> report_replay(const replay::Summary& summary,
                             const std::string& no_fix,
                             bool quiet) {
  Expected<void> reported = report_sources(summary, quiet);
  if (!no_fix.empty() && !quiet) {
    std::fprintf(stderr, "%s\n", no_fix.c_str());
  }
  return reported;
}

void print_replay_notices(const replay::Notices& notices) {
  for (const std::string& line : notices.chains) {
    std::fprintf(stderr, "rayloc replay: %s\n", line.c_str());
  }
  if (!notices.chain_progress.empty()) {
    std::fprintf(stderr, "rayloc replay: at the end: %s\n", notices.chain_progress.c_str());
  }
  for (const std::string& lack : notices.lacks) {
    std::fprintf(stderr, "rayloc replay: %s\n", lack.c_str());
  }
}

}  // namespace rayloc::cli
