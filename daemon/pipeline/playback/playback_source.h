// PlaybackSource: a recording that follows a Playback: it gives out datagrams when they are due,
// then those of the next position.
//
// At the end of the recording it waits for a seek. Datagrams passed over on the way to another
// position, and those read but not given out at the time of a seek, count as not received and are
// in no counter: received = delivered + sum(rejected) holds over all positions.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "capture/transport/datagram_source.h"
#include "daemon/pipeline/playback/playback.h"

namespace rayloc {

class PlaybackSource : public DatagramSource {
 public:
  // Opens the recording anew, at its beginning.
  using Open = std::function<Expected<std::unique_ptr<DatagramSource>>()>;

  static Expected<std::unique_ptr<PlaybackSource>> open(Open open,
                                                        std::shared_ptr<Playback> playback);

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override { return description_; }

 private:
  PlaybackSource(Open open,
                 std::unique_ptr<DatagramSource> recording,
                 std::shared_ptr<Playback> playback);

  Expected<void> go_to(const Playback::Place& place);
  Expected<void> read_on(Duration timeout);
  void give(Timestamp due, DatagramBatch& batch);
  void count();

  const Open open_;
  const std::shared_ptr<Playback> playback_;
  const std::string description_;
  std::unique_ptr<DatagramSource> recording_;
  Playback::Place place_;
  DatagramBatch pending_;  // read from the recording; datagrams from next_ on are still pending
  std::size_t next_ = 0;
  bool passing_ = false;    // over datagrams before the place
  SourceCounters passed_;   // of the recording, on arrival at the place
  SourceCounters earlier_;  // of other places
  SourceCounters here_;     // of this one
  mutable std::mutex mutex_;
  SourceCounters published_;  // guarded by mutex_
};

}  // namespace rayloc
