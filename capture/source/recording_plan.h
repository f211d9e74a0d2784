// RecordingPlan: the scanned files of one access point's recording in order of time, independent of
// the order in which they were named: files of tcpdump -C and -G, of our own recorder, or of a
// recording that was restarted.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/source/pcap_source.h"
#include "capture/source/record_times.h"
#include "engine/base/expected.h"

namespace rayloc {

struct PlannedFile {
  std::string path;
  // Empty for a pipe or standard input, which is read as it arrives.
  std::optional<RecordingScan> scan;
};

// Event time of its first datagram; files without one come before all others.
Timestamp begin_of(const PlannedFile& file);

struct RecordingPlan {
  PcapFileOptions options;         // options of every file, except its times
  std::vector<PlannedFile> files;  // by the first event time; at least one
};

// Options of verbs that only collect frames: unmodified stamps, records a second out of order.
PcapFileOptions as_stamped_options();

// kUsage if a pipe is one of several files, or a file is named twice; otherwise as
// PcapFileSource::open(). REQUIRES: options.max_disorder is not kAnyDisorder.
Expected<RecordingPlan> plan_recording(const std::vector<std::string>& files,
                                       const PcapFileOptions& options = {});

// Event times of the first and the last datagram. Empty if none is available.
std::optional<TimeSpan> span_of(const RecordingPlan& plan);

// Periods with records, without gaps that are longer than options.max_gap; in order.
std::vector<TimeSpan> busy_times(const std::vector<RecordingPlan>& plans);

// Notices for the operator before it is read, a line each: stamps and clocks (record_times.h), gaps
// and overlaps between the files, and packets that a better capture would hold (rejection_words.h).
std::vector<std::string> describe(const RecordingPlan& plan);

// Minimum length of a gap that is reported for such a recording.
Duration least_gap(const PcapFileOptions& options);

// "a.pcap", "a.pcap and 2 more".
std::string name_of(const RecordingPlan& plan);

// By reason: "3 not_udp, 1 time_went_back"; empty if nothing was rejected.
std::string rejections_text(const std::map<std::string, std::uint64_t>& rejected);

}  // namespace rayloc
