// NoFixReasons: counts the reasons for snapshots without a position, for the summary of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "daemon/messages/location.h"

namespace rayloc::cli {

class NoFixReasons {
 public:
  // Takes any location; filtered ones and those with a position are ignored.
  void count(const Location& location);

  // Returns "30 without a fix: no chain gains, calibrate the site (30)", the
  // most frequent reason first; empty when every snapshot has a position.
  std::string text() const;

 private:
  // Number of reasons shown; a snapshot with another reason is counted with the others.
  static constexpr std::size_t kReasons = 8;
  std::map<std::string, std::uint64_t> counts_;
  std::uint64_t all_ = 0;
};

}  // namespace rayloc::cli
