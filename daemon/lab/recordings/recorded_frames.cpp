#include "daemon/lab/recordings/recorded_frames.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "capture/assemble/chain_presence.h"
#include "capture/assemble/csi_receiver.h"
#include "capture/decode/csi_decoder.h"
#include "capture/source/recorded_source.h"
#include "capture/source/rejection_words.h"
#include "capture/source/source_advice.h"
#include "daemon/lab/recordings/time_text.h"
#include "daemon/pipeline/watch/stamp_check.h"
#include "daemon/site/model/receiver_options.h"

namespace rayloc {
namespace {

// The reasons for which whole datagrams were rejected, with advice; empty if none were.
std::string trouble_of(const CsiReceiverCounters& counters) {
  std::string text;
  for (const std::string& trouble : counters.troubles) {
    text += (text.empty() ? "" : "; ") + trouble;
  }
  text += text.empty() ? "" : "; no position is made of them";
  for (const auto& [reason, count] : counters.rejected) {
    if (const std::string_view advice = source_advice(reason); !advice.empty()) {
      text += ": " + std::string(advice);
    }
  }
  return text;
}

// The channels of a hopping device, or the changes of a channel that should be constant.
std::vector<std::string> channel_changes(const CsiReceiverCounters& counters) {
  if (counters.hops.size() > 1) {
    std::string text;
    for (const auto& [channel, datagrams] : counters.hops) {
      text += (text.empty() ? "" : ", ") + std::to_string(datagrams) + " of " + to_string(channel);
    }
    return {"packets of " + std::to_string(counters.hops.size()) + " channels are used: " + text};
  }
  std::vector<std::string> lines;
  for (const ChannelChange& change : counters.first_changes) {
    lines.push_back("the channel changed at " + time_text(change.time) + " from " +
                    to_string(change.from) + " to " + to_string(change.to));
  }
  if (counters.channel_changes > lines.size()) {
    lines.push_back("the channel changed " +
                    std::to_string(counters.channel_changes - lines.size()) + " more times");
  }
  return lines;
}

}  // namespace

Expected<void> for_each_frame(const Site& site,
                              const RecordingArgument& recording,
                              const std::function<void(CsiFrame&&)>& take,
                              std::vector<std::string>& notes) {
  const auto index = find_access_point(site, recording.access_point);
  RAYLOC_TRY(index);
  auto source = RecordedSource::open(recording.files, as_stamped_options());
  RAYLOC_TRY(source);
  CsiReceiver receiver(receiver_options(site, *index));
  StampTally stamps;
  DatagramBatch batch;
  std::vector<CsiFrame> frames;
  while (!batch.ended) {
    frames.clear();
    RAYLOC_TRY((*source)->read(batch, std::chrono::seconds(1)));
    stamps.add(batch.datagrams);
    for (const Datagram& datagram : batch.datagrams) {
      receiver.push(datagram, frames);
    }
    if (batch.ended) {
      receiver.flush(frames);
    }
    stamps.add(frames);
    for (CsiFrame& frame : frames) {
      take(std::move(frame));
    }
  }
  const CsiReceiverCounters counters = receiver.counters();
  if (const std::string trouble = trouble_of(counters); !trouble.empty() && counters.frames == 0) {
    return bad_input((*source)->description() + ": access point '" + recording.access_point +
                     "': " + trouble);
  }
  note_recording(**source, counters, recording.access_point, notes);
  if (std::string text = stamps.text(); !text.empty()) {
    notes.push_back(recording.access_point + ": " + (*source)->description() + ": " + text);
  }
  return {};
}

std::uint64_t addresses_refused(const CsiReceiverCounters& decoded) {
  std::uint64_t refused = 0;
  for (const RejectReason reason : {RejectReason::kGroupAddress, RejectReason::kZeroAddress}) {
    const auto found = decoded.rejected.find(std::string(to_string(reason)));
    refused += found == decoded.rejected.end() ? 0 : found->second;
  }
  return refused;
}

void note_recording(const RecordedSource& source,
                    const CsiReceiverCounters& decoded,
                    const std::string& access_point,
                    std::vector<std::string>& notes) {
  const std::string whose = access_point.empty() ? "" : access_point + ": ";
  for (const std::vector<std::string>& words : {describe(source.plan()), source.warnings()}) {
    for (const std::string& line : words) {
      notes.push_back(whose + line);
    }
  }
  const SourceCounters read = source.counters();
  auto rejected = read.rejected;
  rejected.erase("gap_mark");  // is reported by its content
  for (const auto& [reason, count] : decoded.rejected) {
    rejected[reason] += count;
  }
  for (const std::string& line :
       rejection_words(decoded.rejected, decoded.received, source.description())) {
    notes.push_back(whose + line);
  }
  const std::string what = whose + source.description() + ": ";
  if (const std::string reasons = rejections_text(rejected); !reasons.empty()) {
    notes.push_back(what + "of " + std::to_string(read.received) + " packets rejected: " + reasons);
  }
  for (const std::string& line : channel_changes(decoded)) {
    notes.push_back(what + line);
  }
  if (const std::string trouble = trouble_of(decoded); !trouble.empty()) {
    notes.push_back(what + trouble);
  }
  if (const std::uint64_t refused = addresses_refused(decoded); refused > 0) {
    notes.push_back(what + std::to_string(refused) +
                    " packets state a group address or zero as their transmitter: no device has "
                    "one; see the extractor's filter of addresses, or state it as [[transmitter]] "
                    "in site.toml");
  }
  for (const auto& [rx_chain, frames] : decoded.without_rx_chain) {
    if (frames >= ChainPresence::kFrames && 2 * frames > decoded.frames) {
      notes.push_back(
          what + "core " + std::to_string(rx_chain) + " has no CSI in " + std::to_string(frames) +
          " of " + std::to_string(decoded.frames) +
          " frames: check its antenna and pigtail, and that the extractor is set to measure it");
    }
  }
  if (const auto marks = read.rejected.find("gap_mark"); marks != read.rejected.end()) {
    notes.push_back(what + "gaps are marked in the recording: " + std::to_string(marks->second) +
                    ", with at least " + std::to_string(read.unrecorded) +
                    " datagrams that were received and not recorded");
  }
}

std::optional<MacAddress> keep_most_received(std::vector<CsiFrame>& frames) {
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

}  // namespace rayloc
