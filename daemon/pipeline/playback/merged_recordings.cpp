#include "daemon/pipeline/playback/merged_recordings.h"

#include <chrono>
#include <utility>

namespace rayloc {

MergedRecordings::MergedRecordings(std::vector<std::unique_ptr<DatagramSource>> sources,
                                   std::function<bool()> is_stopped)
    : is_stopped_(std::move(is_stopped)) {
  for (auto& source : sources) {
    recordings_.push_back({std::move(source), {}, 0});
  }
}

Expected<MergedRecordings::Next> MergedRecordings::next() {
  if (last_ != nullptr) {
    ++last_->next;
  }
  Next earliest;
  for (std::size_t i = 0; i < recordings_.size(); ++i) {
    RAYLOC_TRY(fill(recordings_[i]));
    const Datagram* candidate = recordings_[i].front();
    if (candidate != nullptr &&
        (earliest.datagram == nullptr || candidate->time < earliest.datagram->time)) {
      earliest = {i, candidate};
    }
  }
  last_ = earliest.datagram != nullptr ? &recordings_[earliest.recording] : nullptr;
  return earliest;
}

std::map<std::string, std::uint64_t> MergedRecordings::rejected() const {
  std::map<std::string, std::uint64_t> all;
  for (const Recording& recording : recordings_) {
    for (const auto& [reason, count] : recording.source->counters().rejected) {
      all[reason] += count;
    }
  }
  return all;
}

std::vector<std::string> MergedRecordings::warnings() const {
  std::vector<std::string> all;
  for (const Recording& recording : recordings_) {
    for (std::string& warning : recording.source->warnings()) {
      all.push_back(std::move(warning));
    }
  }
  return all;
}

// Waits while a pipe has no data.
Expected<void> MergedRecordings::fill(Recording& recording) const {
  while (recording.front() == nullptr && !recording.batch.ended && !is_stopped_()) {
    RAYLOC_TRY(recording.source->read(recording.batch, std::chrono::milliseconds(200)));
    recording.next = 0;
  }
  return {};
}

}  // namespace rayloc
