// PlaybackSource: a recording that follows a Playback: its datagrams when they are due, then those
// of another place.
//
// At the end of the recording it rests and waits to be moved. What is passed over on the way to
// another place was not received: it is in no counter. What had been read and not given out when
// the move came is not, either: received = delivered + sum(rejected) holds over all places.
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
  DatagramBatch pending_;  // read from the recording; datagrams from next_ on are still to come
  std::size_t next_ = 0;
  bool passing_ = false;    // over what lies before the place
  SourceCounters passed_;   // of the recording, when it came to the place
  SourceCounters earlier_;  // of other places
  SourceCounters here_;     // of this one
  mutable std::mutex mutex_;
  SourceCounters published_;  // guarded by mutex_
};

}  // namespace rayloc
