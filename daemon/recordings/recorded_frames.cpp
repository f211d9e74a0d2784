#include "daemon/recordings/recorded_frames.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/source/recorded_source.h"
#include "daemon/site/receiver_options.h"

namespace rayloc::cli {

Expected<void> for_each_frame(const Site& site,
                              const RecordingArgument& recording,
                              const std::function<void(CsiFrame&&)>& take,
                              std::vector<std::string>& notes,
                              ChannelTally* channels) {
  const auto index = find_access_point(site, recording.access_point);
  if (!index) {
    return tl::make_unexpected(index.error());
  }
  auto source = RecordedSource::open(recording.files, as_stamped_options());
  if (!source) {
    return tl::make_unexpected(std::move(source.error()));
  }
  CsiReceiver receiver(receiver_options(site, *index));
  ChannelTally tally;
  DatagramBatch batch;
  std::vector<CsiFrame> frames;
  while (!batch.ended) {
    frames.clear();
    if (auto read = (*source)->read(batch, std::chrono::seconds(1)); !read) {
      return tl::make_unexpected(std::move(read.error()));
    }
    for (const Datagram& datagram : batch.datagrams) {
      receiver.push(datagram, frames);
      (channels == nullptr ? tally : *channels).add(datagram.payload);
    }
    if (batch.ended) {
      receiver.flush(frames);
    }
    for (CsiFrame& frame : frames) {
      take(std::move(frame));
    }
  }
  note_recording(**source, receiver.counters(), recording.access_point, notes);
  if (const auto channel = tally.most()) {
    if (auto text = other_channel_text(site, recording.access_point, *channel); !text.empty()) {
      notes.push_back(std::move(text));
    }
  }
  return {};
}

void note_recording(const RecordedSource& source,
                    const CsiReceiverCounters& decoded,
                    const std::string& access_point,
                    std::vector<std::string>& notes) {
  const std::string whose = access_point.empty() ? "" : access_point + ": ";
  for (const std::vector<std::string>& words : {words_of(source.plan()), source.warnings()}) {
    for (const std::string& line : words) {
      notes.push_back(whose + line);
    }
  }
  const SourceCounters read = source.counters();
  auto rejected = read.rejected;
  rejected.erase("gap_mark");  // is told as what it says
  for (const auto& [reason, count] : decoded.rejected) {
    rejected[reason] += count;
  }
  const std::string what = whose + source.description() + ": ";
  if (const std::string reasons = rejections_text(rejected); !reasons.empty()) {
    notes.push_back(what + "of " + std::to_string(read.received) + " packets rejected: " + reasons);
  }
  if (const auto marks = read.rejected.find("gap_mark"); marks != read.rejected.end()) {
    notes.push_back(what + "gaps are marked in the recording: " + std::to_string(marks->second) +
                    ", with at least " + std::to_string(read.unrecorded) +
                    " datagrams that were received and not recorded");
  }
}

std::optional<MacAddress> keep_most_heard(std::vector<CsiFrame>& frames) {
  std::map<MacAddress, std::size_t> counts;
  for (const CsiFrame& frame : frames) {
    ++counts[frame.transmitter];
  }
  if (counts.size() < 2) {
    return std::nullopt;
  }
  const MacAddress most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      })->first;
  std::erase_if(frames, [&](const CsiFrame& frame) { return frame.transmitter != most; });
  return most;
}

}  // namespace rayloc::cli
