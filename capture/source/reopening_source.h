// ReopeningSource: a live source that is reopened after a failure. When its source fails (an
// interface that is removed, a socket that returns an error) it is closed, counted, and opened
// again after a second, then two, four, ... thirty; meanwhile its event time advances, so that no
// reader waits for it.
//
// The wait is reset once the source has been read for as long as the longest wait: a source that
// fails at every read is not opened every second. Datagrams received after it was opened are never
// before a watermark that was returned while it was closed. Thread safety: one thread reads;
// counters() from any.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "capture/source/event_clock.h"
#include "capture/transport/datagram_source.h"

namespace rayloc {

class ReopeningSource final : public DatagramSource {
 public:
  using Open = std::function<Expected<std::unique_ptr<DatagramSource>>()>;
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kShortestWait{1};
  static constexpr std::chrono::seconds kLongestWait{30};

  // Opens it for the first time: a failure then is the caller's Error. `now`: clock for the waits.
  static Expected<std::unique_ptr<ReopeningSource>> open(
      Open open, std::function<Time()> now = std::chrono::steady_clock::now);

  // Never an Error.
  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override { return description_; }
  std::string trouble() const override { return trouble_; }
  std::optional<int> poll_descriptor() const override {
    return source_ ? source_->poll_descriptor() : std::optional(-1);
  }

 private:
  ReopeningSource(Open open, std::function<Time()> now, std::unique_ptr<DatagramSource> source);
  void read_closed(DatagramBatch& batch, Duration timeout);
  void keep_promises(DatagramBatch& batch);
  bool reopen();
  void close(const Error& why);
  void try_later(const Error& why);

  const Open open_;
  const std::function<Time()> now_;
  const std::string description_;
  std::string trouble_;  // empty while the source is open
  std::chrono::seconds wait_ = kShortestWait;
  Time opened_;
  Time next_try_;
  EventClock clock_;  // gives the time while the source is closed, and counts steps throughout
  Timestamp watermark_ = Timestamp::min();

  mutable std::mutex mutex_;
  std::unique_ptr<DatagramSource> source_;  // set under mutex_; null while it is closed
  SourceCounters before_;  // counters of closed sources, and clock_steps; guarded by mutex_
};

}  // namespace rayloc
