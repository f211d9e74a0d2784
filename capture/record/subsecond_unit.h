// SubsecondUnit: detects the unit of the sub-second field of a classic pcap. The header states it,
// but some programs write nanoseconds under the magic number of microseconds, or the reverse, and
// the values show it:
//   - Microseconds end at 999,999. If most values are higher, they are nanoseconds.
//   - One nanosecond value in a thousand is below 1,000,000. If all values are, in several seconds,
//     and they spread over this whole range, they are microseconds.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/timestamp.h"

namespace rayloc::pcap {

enum class TimeUnit : std::uint8_t { kMicroseconds, kNanoseconds };

class SubsecondUnit {
 public:
  // `known`: the unit that an earlier scan of the whole file determined.
  explicit SubsecondUnit(TimeUnit stated, std::optional<TimeUnit> known = {})
      : stated_(stated), known_(known) {}

  // REQUIRES: the order of the file. Returns the duration that the value denotes.
  Duration add(std::uint32_t seconds, std::uint32_t fraction);

  TimeUnit stated() const { return stated_; }
  // The unit by which the last value was read.
  TimeUnit used() const;
  // The unit by the values so far; the stated one if they do not contradict it.
  TimeUnit shown() const;
  // At least one value was read by another unit than shown().
  bool misread() const;

 private:
  bool fills_microseconds() const;

  TimeUnit stated_;
  std::optional<TimeUnit> known_;
  bool used_micro_ = false;
  bool used_nano_ = false;
  std::uint64_t below_ = 0;  // values valid in both units; zeros are not informative
  std::uint64_t above_ = 0;  // values that are invalid as microseconds
  std::optional<std::uint32_t> first_second_;
  bool spans_seconds_ = false;
  std::uint32_t sixteenths_ = 0;  // bit i: a value in [i, i + 1) 1/16 s, read as microseconds
};

}  // namespace rayloc::pcap
