// TargetNames: the name of a transmitter in all output of the daemon: its address, or, if privacy
// is configured, a keyed hash of it that changes at intervals.
//
// The hash is the first 128 bits of HMAC-SHA-256 over the address, in hex. Time is divided into
// periods of event time, counted from 1970 in UTC. Without a key each period has a random one,
// which is never stored and soon discarded: then no person, including the operator, can identify a
// hash, and after a restart hashes are new. With a key (a file of the operator) hashes are a
// function of key, period and address, so that a replay gives the same.
//
// A plain hash would hide nothing: all 2^48 addresses can be tried. A hash cannot hide the path of
// a person: a stationary target whose name changes is easily followed.
//
// Thread safety: any thread.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/channel/mac_address.h"

namespace rayloc {

class TargetNames {
 public:
  struct Options {
    bool hashed = false;
    Duration period = std::chrono::hours(24);
    std::string key = {};  // empty: a random one for each period
  };
  TargetNames() = default;
  explicit TargetNames(Options options) : options_(std::move(options)) {}

  bool hashed() const { return options_.hashed; }
  // "02:52:4c:00:00:01", or 32 hexadecimal digits. `time`: of the event.
  std::string text(const MacAddress& transmitter, Timestamp time);

  // The first line of the file. kConfiguration if it has less than 32 characters, or if every user
  // of the machine may read it.
  static Expected<std::string> read_key(const std::filesystem::path& file);

 private:
  using Key = std::array<std::uint8_t, 32>;
  Key key_of(std::int64_t period);

  const Options options_ = {};
  std::mutex mutex_;
  std::map<std::int64_t, Key> keys_;  // random keys, by period; guarded by mutex_
};

}  // namespace rayloc
