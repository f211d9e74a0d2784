#include "daemon/pipeline/playback/playback_source.h"

#include <algorithm>
#include <utility>

namespace rayloc {
namespace {

// Maximum number of reads while passing over datagrams, before read() returns to report progress.
constexpr int kReadsAtOnce = 64;

}  // namespace

PlaybackSource::PlaybackSource(Open open,
                               std::unique_ptr<DatagramSource> recording,
                               std::shared_ptr<Playback> playback)
    : open_(std::move(open)),
      playback_(std::move(playback)),
      description_(recording->description()),
      recording_(std::move(recording)) {}

Expected<std::unique_ptr<PlaybackSource>> PlaybackSource::open(Open open,
                                                               std::shared_ptr<Playback> playback) {
  auto recording = open();
  RAYLOC_TRY(recording);
  return std::unique_ptr<PlaybackSource>(
      new PlaybackSource(std::move(open), std::move(*recording), std::move(playback)));
}

Expected<void> PlaybackSource::go_to(const Playback::Place& place) {
  auto recording = open_();
  RAYLOC_TRY(recording);
  recording_ = std::move(*recording);
  place_ = place;
  pending_ = {};
  next_ = 0;
  passing_ = true;
  passed_ = {};
  add_counts(earlier_, here_);
  here_ = {};
  return {};
}

// Reads until datagrams are ready, or for a limited number of reads.
Expected<void> PlaybackSource::read_on(Duration timeout) {
  for (int i = 0; i < kReadsAtOnce && next_ == pending_.datagrams.size() && !pending_.ended; ++i) {
    next_ = 0;
    RAYLOC_TRY(recording_->read(pending_, timeout));
    std::erase_if(pending_.datagrams,
                  [&](const Datagram& datagram) { return datagram.time < place_.from; });
    passing_ = passing_ && pending_.datagrams.empty();
    if (passing_) {
      passed_ = recording_->counters();
    }
  }
  return {};
}

void PlaybackSource::give(Timestamp due, DatagramBatch& batch) {
  while (next_ < pending_.datagrams.size() && pending_.datagrams[next_].time <= due) {
    batch.datagrams.push_back(pending_.datagrams[next_++]);
    ++here_.delivered;
    here_.bytes += batch.datagrams.back().payload.size();
    playback_->given(batch.datagrams.back().time, place_.number);
  }
}

Expected<void> PlaybackSource::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  batch.moved.reset();
  batch.watermark = Timestamp::min();
  const auto deadline =
      Playback::Clock::now() + std::chrono::duration_cast<Playback::Clock::duration>(timeout);
  if (const Playback::Place place = playback_->place(); place.number != place_.number) {
    batch.moved = place.number;
    return go_to(place);
  }
  RAYLOC_TRY(read_on(timeout));
  if (next_ < pending_.datagrams.size()) {
    give(playback_->wait_for(pending_.datagrams[next_].time, place_.number, deadline), batch);
  } else if (pending_.ended) {
    playback_->wait_at_end(place_.number, deadline);
  }
  if (!passing_) {
    batch.watermark = pending_.watermark;
    for (std::size_t i = next_; i < pending_.datagrams.size(); ++i) {
      batch.watermark = std::min(batch.watermark, pending_.datagrams[i].time);
    }
  }
  batch.at_end = pending_.ended && next_ == pending_.datagrams.size();
  batch.watermark = batch.at_end ? Timestamp::max() : batch.watermark;
  count();
  return {};
}

void PlaybackSource::count() {
  const SourceCounters read = recording_->counters();
  here_.received = here_.delivered;
  here_.unrecorded = read.unrecorded - passed_.unrecorded;
  for (const auto& [reason, count] : read.rejected) {
    const auto before = passed_.rejected.find(reason);
    here_.rejected[reason] = count - (before == passed_.rejected.end() ? 0 : before->second);
    here_.received += here_.rejected[reason];
  }
  const std::lock_guard lock(mutex_);
  published_ = earlier_;
  add_counts(published_, here_);
}

SourceCounters PlaybackSource::counters() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

}  // namespace rayloc
