// TargetNames: what a transmitter is called in everything that leaves the daemon: its address, or,
// when privacy is wanted, a keyed hash of it that changes every so often.
//
// The hash is the first 128 bits of HMAC-SHA-256 over the address, in hex. Time is cut into periods
// of event time, counted from 1970 in UTC. Without a key each period has a random one, which is
// never written anywhere and is forgotten soon after: then nobody, the operator included, can say
// any more who a hash was, and after a restart hashes are new. With a key (a file that the operator
// keeps) hashes are a function of key, period and address, so that a replay gives the same.
//
// A plain hash would hide nothing: all 2^48 addresses can be tried. What a hash cannot hide is
// where somebody went: a target that stands still while the name changes is easily followed.
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

  // The first line of the file. kConfiguration when that has less than 32 characters, or when
  // everyone on the machine may read it.
  static Expected<std::string> read_key(const std::filesystem::path& file);

 private:
  using Key = std::array<std::uint8_t, 32>;
  Key key_of(std::int64_t period);

  const Options options_ = {};
  std::mutex mutex_;
  std::map<std::int64_t, Key> keys_;  // guarded by mutex_; random ones, by period
};

}  // namespace rayloc
