// RecordingPlan: the files that one access point was recorded in, looked through and in order of
// time, whatever the order in which they were named: what tcpdump -C and -G write, our own
// recorder, or somebody who began anew.
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
  // Nothing of a pipe or standard input, which is read as it comes.
  std::optional<RecordingLook> look;
};

// Of its first datagram, in event time; files without one come before all others.
Timestamp begin_of(const PlannedFile& file);

struct RecordingPlan {
  PcapFileOptions options;         // for every file, but for its times
  std::vector<PlannedFile> files;  // by the first event time; at least one
};

// The verbs that only collect frames: stamps as they are, and records a second out of order.
PcapFileOptions as_stamped_options();

// kUsage when a pipe is one of several files, or a file is named twice; else as
// PcapFileSource::open(). REQUIRES: options.max_disorder is not kAnyDisorder.
Expected<RecordingPlan> plan_recording(const std::vector<std::string>& files,
                                       const PcapFileOptions& options = {});

// In event time: of the first and the last datagram. Nothing when none is known of.
std::optional<TimeSpan> span_of(const RecordingPlan& plan);

// When something was recorded, without gaps that are longer than options.max_gap; in order.
std::vector<TimeSpan> busy_times(const std::vector<RecordingPlan>& plans);

// What people should know before it is read, a line each: stamps and clocks (record_times.h), gaps
// and overlaps between the files, and packets that a better capture would hold (rejection_words.h).
std::vector<std::string> words_of(const RecordingPlan& plan);

// From how long on a gap of such a recording is spoken of.
Duration least_gap(const PcapFileOptions& options);

// "a.pcap", "a.pcap and 2 more".
std::string name_of(const RecordingPlan& plan);

// By reason: "3 not_udp, 1 time_went_back"; empty when nothing was rejected.
std::string rejections_text(const std::map<std::string, std::uint64_t>& rejected);

}  // namespace rayloc
