// RecordingSender: sends recordings to sinks as the access points did, at the recorded pace or at a
// fixed rate.
//
// All recordings follow one clock (CLOCK_MONOTONIC), so that datagrams of different access points
// keep their distance in time. Each datagram leaves with its recorded addresses and payload and the
// present wall-clock time.
#pragma once

#include <functional>
#include <optional>

#include "capture/source/record_times.h"
#include "capture/transport/sink_queue.h"
#include "daemon/pipeline/playback/merged_recordings.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Receives the events of sending, from the thread that sends. Empty functions: nothing is reported.
// `time_offset`: recorded time + offset = time of arrival; empty if no single offset converts them.
struct SendObserver {
  std::function<void(std::optional<Duration> time_offset)> on_start;
  // Datagrams behind a gap of the recordings are sent earlier by `skipped`.
  std::function<void(Duration gap, Duration skipped, std::optional<Duration> time_offset)> on_gap;
};

struct PacedSending {
  double speed = 1.0;                   // recorded seconds per second, > 0; infinite: at once
  std::optional<double> duration = {};  // [s], of sending; default: to the end of the recordings
  Duration max_gap = kMaxGap;           // maximum wait where the recordings contain no data
};

struct SendOutcome {
  Duration elapsed{};
  Duration latest{};  // largest delay of a datagram
};

// Thread safety: one thread.
class RecordingSender {
 public:
  // `recordings` and `sinks` must outlive it; the i-th recording is sent to the i-th sink.
  // `is_stopped` ends the sending early; a signal (EINTR) makes a wait check it.
  RecordingSender(MergedRecordings& recordings,
                  SinkQueue& sinks,
                  SendObserver observer,
                  std::function<bool()> is_stopped);

  // Sends each datagram at the recording's time divided by the speed, without the skipped parts of
  // gaps. An Error of a recording or sink ends it.
  Expected<SendOutcome> send_paced(const PacedSending& options);

  // Sends `rate` datagrams per second (> 0) and repeats the recordings until `duration` [s] ends
  // (once without a duration). The recordings are kept in memory: more than 1 GiB is an Error
  // (kUsage).
  Expected<SendOutcome> send_at_rate(double rate, std::optional<double> duration);

 private:
  void report_start(std::optional<Duration> time_offset) const;
  void sleep_until(Duration monotonic) const;

  MergedRecordings& recordings_;
  SinkQueue& sinks_;
  SendObserver observer_;
  std::function<bool()> is_stopped_;
};

}  // namespace rayloc
