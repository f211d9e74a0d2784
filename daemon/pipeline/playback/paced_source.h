// PacedSource: plays a recording at the pace at which it was made, or N times faster.
//
// Several recordings that belong together share one Pace and stay synchronised. The datagrams and
// their times are those of the recording: results do not depend on speed. Where none of them
// contains data for longer than `max_gap` playback does not wait longer than that: the device was
// absent, or a clock was set.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/source/record_times.h"
#include "capture/transport/datagram_source.h"

namespace rayloc {

// Maps event time to the steady clock. The first datagram of any source is "now". Thread safety:
// any thread.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  // speed: recorded seconds per second, > 0.
  explicit Pace(double speed, Duration max_gap = kMaxGap) : speed_(speed), max_gap_(max_gap) {}

  // Adds a recording that is to stay synchronised; returns its number.
  std::size_t join();
  // The recording has ended: the others do not wait for it.
  void leave(std::size_t recording);

  // The instant at which a datagram of that event time is due, which is the next one of a recording
  // that has joined.
  Clock::time_point due(std::size_t recording, Timestamp next);

 private:
  Clock::time_point when(Timestamp event) const;

  const double speed_;
  const Duration max_gap_;
  std::mutex mutex_;
  std::optional<Timestamp> event_origin_;
  Clock::time_point origin_;
  // By recording: the next datagram. Empty: not read yet.
  std::vector<std::optional<Timestamp>> next_;
};

class PacedSource : public DatagramSource {
 public:
  PacedSource(std::unique_ptr<DatagramSource> recording, std::shared_ptr<Pace> pace)
      : recording_(std::move(recording)), pace_(std::move(pace)), number_(pace_->join()) {}
  ~PacedSource() override { pace_->leave(number_); }
  PacedSource(const PacedSource&) = delete;
  PacedSource& operator=(const PacedSource&) = delete;

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override { return recording_->counters(); }
  std::string description() const override { return recording_->description(); }

 private:
  std::unique_ptr<DatagramSource> recording_;
  std::shared_ptr<Pace> pace_;
  const std::size_t number_;
  DatagramBatch pending_;  // read from the recording; datagrams from next_ on are still pending
  std::size_t next_ = 0;
};

}  // namespace rayloc
