// StreamReader: every message of a stream in its order, from some place on, without a consumer.
//
// It listens to what the stream tells again of each message that it stores. What is missing there,
// or was before, is asked for by sequence (direct get), which any replica answers; one that lags
// says that there is none, and then the leader is asked. So there is nothing to acknowledge and
// nothing on the server that a dead machine could hold on to; consumers could not be made in 38 %
// of tries after one of three servers had died.
//
// Thread safety: one thread reads; counters() from any.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "daemon/cluster/broker.h"

namespace rayloc {

class StreamReader {
 public:
  struct Place {
    Timestamp created{};         // of the stream; the epoch: any
    std::uint64_t sequence = 0;  // of the last message that was read; 0: none
  };
  struct Options {
    std::string stream;
    std::string again;  // the subjects that it tells its messages on
    Place after;
    // After so long without a message the next one is asked for.
    std::chrono::milliseconds quiet{200};
    // What waits here to be read; what is more is asked for later.
    std::size_t max_waiting_bytes = std::size_t{32} << 20U;
  };

  static Expected<std::unique_ptr<StreamReader>> open(std::shared_ptr<Broker> broker,
                                                      Options options);

  // The next message; nothing when none came for so long, or while the broker is away.
  std::optional<BrokerMessage> next(std::chrono::milliseconds timeout);

  // Behind the last message that was read.
  const Place& place() const { return place_; }

  struct Counters {
    std::uint64_t read = 0;
    std::uint64_t asked_for = 0;  // of these, by sequence
    std::uint64_t lost = 0;       // the stream did not have them any more
    std::uint64_t streams = 0;  // how often it was another one: its server has forgotten the first
  };
  Counters counters() const;
  // Of the last look at the stream; empty: all is well.
  std::string trouble() const;

 private:
  using Time = std::chrono::steady_clock::time_point;

  StreamReader(std::shared_ptr<Broker> broker, Options options);
  void take(BrokerMessage&& message);
  bool look_at_stream();
  std::optional<BrokerMessage> waiting_one(Time until, bool& hole);
  std::optional<BrokerMessage> ask_for_next(bool hole);
  bool seems_shorter(const StreamState& state, Time now);
  std::optional<BrokerMessage> ask_the_leader();
  BrokerMessage accept(BrokerMessage&& message, bool asked_for);

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  Place place_;
  std::uint64_t connections_ = 0;  // when the stream was last looked at; 0: it was not there
  Time looked_;
  Time heard_;                   // or asked for the last time
  std::optional<Time> missing_;  // since when the next message is nowhere, although later ones are
  std::optional<Time> shorter_;  // since when the stream ends before what was read of it
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<BrokerMessage> waiting_;  // guarded by mutex_; ascending
  std::size_t waiting_bytes_ = 0;      // guarded by mutex_
  std::uint64_t last_told_ = 0;        // guarded by mutex_
  bool in_doubt_ = false;              // guarded by mutex_: whether it is still the same stream
  Counters counters_;                  // guarded by mutex_
  std::string trouble_;                // guarded by mutex_
  std::unique_ptr<Broker::Subscription> subscription_;  // last: ends before what it looks at
};

}  // namespace rayloc
