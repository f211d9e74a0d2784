// NoFixReasons: why snapshots have no position, and how many each: for the end of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "daemon/publish/location.h"

namespace rayloc::cli {

class NoFixReasons {
 public:
  // Of any location; what is filtered, or has a position, counts for nothing.
  void count(const Location& location);

  // "30 without a fix: no chain gains, calibrate the site (30)", the most frequent reason first;
  // empty when none is without.
  std::string text() const;

 private:
  // As many as anybody reads; a snapshot with yet another reason is one of the others.
  static constexpr std::size_t kReasons = 8;
  std::map<std::string, std::uint64_t> counts_;
  std::uint64_t all_ = 0;
};

}  // namespace rayloc::cli
