// StreamReader: reads every message of a stream in order, from a given place, without a consumer.
//
// It subscribes to the messages that the stream republishes on storage. Messages missing there, and
// earlier ones, are requested by sequence (direct get), from server 2.11 on many by one request.
// Any replica answers; one that lags reports that there is none, and then the leader is asked. So
// there is nothing to acknowledge and no state on the server that belongs to a dead machine;
// consumers could not be made in 38 % of tries after one of three servers had died.
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

#include "daemon/live/cluster/broker.h"

namespace rayloc {

class StreamReader {
 public:
  struct Place {
    Timestamp created{};         // of the stream; zero value: any
    std::uint64_t sequence = 0;  // of the last message that was read; 0: none
  };
  struct Options {
    std::string stream;
    std::string again;  // subjects of the republished messages
    Place after;
    // After so long without a message the next one is requested.
    std::chrono::milliseconds quiet{200};
    // Size of the queue of messages; what exceeds it is requested later.
    std::size_t max_waiting_bytes = std::size_t{32} << 20U;
    // Most that one request returns: 8 MiB are some seven seconds of a site with five access
    // points.
    std::size_t max_requested = 512;
    std::size_t max_requested_bytes = std::size_t{8} << 20U;
  };

  static Expected<std::unique_ptr<StreamReader>> open(std::shared_ptr<Broker> broker,
                                                      Options options);

  // Returns the next message; nothing when none came within `timeout`, or the broker is away.
  std::optional<BrokerMessage> next(std::chrono::milliseconds timeout);

  // Place after the last message that was read.
  const Place& place() const { return place_; }

  struct Counters {
    std::uint64_t read = 0;
    std::uint64_t asked_for = 0;  // part of `read`: requested by sequence
    std::uint64_t lost = 0;       // no longer in the stream
    std::uint64_t streams = 0;    // replacements of the stream: its server had lost the first
  };
  Counters counters() const;
  // Result of the last check of the stream; empty: no fault.
  std::string trouble() const;

 private:
  using Time = std::chrono::steady_clock::time_point;

  StreamReader(std::shared_ptr<Broker> broker, Options options);
  void take(BrokerMessage&& message);
  bool check_stream();
  std::optional<BrokerMessage> requested_one();
  std::optional<BrokerMessage> waiting_one(Time until, std::uint64_t& hole);
  std::optional<BrokerMessage> ask_for_next(std::uint64_t hole);
  bool seems_shorter(const StreamState& state, Time now);
  std::optional<BrokerMessage> ask_the_leader();
  BrokerMessage accept(BrokerMessage&& message, bool asked_for);

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  Place place_;
  std::uint64_t connections_ = 0;  // at the last check of the stream; 0: it did not exist
  Time checked_;
  Time received_;                // or last requested
  std::optional<Time> missing_;  // since when the next message is missing while later ones exist
  std::deque<BrokerMessage> requested_;  // that were received and are to be read; ascending
  std::optional<Time> shorter_;          // since when the stream ends before the last message read
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<BrokerMessage> waiting_;  // guarded by mutex_; ascending
  std::size_t waiting_bytes_ = 0;      // guarded by mutex_
  std::uint64_t last_sequence_ = 0;    // guarded by mutex_
  bool is_suspect_ = false;            // guarded by mutex_: the stream may be another one
  Counters counters_;                  // guarded by mutex_
  std::string trouble_;                // guarded by mutex_
  std::unique_ptr<Broker::Subscription> subscription_;  // last: ends before the members it uses
};

}  // namespace rayloc
