// PacedSource: a recording given out at the pace at which it was made, or N times faster.
//
// Several recordings that belong together share one Pace, so that they stay in step. The datagrams
// and their times are those of the recording: what is computed from them does not depend on speed.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/datagram_source.h"

namespace rayloc {

// Maps event time to the steady clock. The first datagram that any source shows is "now".
// Thread safety: any thread.
class Pace {
 public:
  // speed: recorded seconds per second, > 0.
  explicit Pace(double speed) : speed_(speed) {}

  // The instant at which a datagram of that event time is due.
  std::chrono::steady_clock::time_point due(Timestamp event);

 private:
  const double speed_;
  std::mutex mutex_;
  std::optional<Timestamp> event_origin_;
  std::chrono::steady_clock::time_point origin_;
};

class PacedSource : public DatagramSource {
 public:
  PacedSource(std::unique_ptr<DatagramSource> recording, std::shared_ptr<Pace> pace)
      : recording_(std::move(recording)), pace_(std::move(pace)) {}

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override { return recording_->counters(); }
  std::string description() const override { return recording_->description(); }

 private:
  std::unique_ptr<DatagramSource> recording_;
  std::shared_ptr<Pace> pace_;
  DatagramBatch pending_;  // read from the recording; datagrams from next_ on are still to come
  std::size_t next_ = 0;
};

}  // namespace rayloc
