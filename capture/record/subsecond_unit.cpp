#include "capture/record/subsecond_unit.h"

namespace rayloc::pcap {
namespace {

constexpr std::uint32_t kMicrosecondEnd = 1'000'000;
constexpr std::uint32_t kNanosecondEnd = 1'000'000'000;

// Fewer values do not show the unit: a short burst of nanoseconds may fit in one millisecond.
constexpr std::uint64_t kMinValues = 8;
constexpr std::uint64_t kPerOutlier = 50;  // damaged values do not hide the unit of the others
// A sender that is synchronised to the second leaves most of the range empty.
constexpr unsigned kMaxEmptySixteenths = 5;

}  // namespace

Duration SubsecondUnit::add(std::uint32_t seconds, std::uint32_t fraction) {
  if (fraction >= kMicrosecondEnd && fraction < kNanosecondEnd) {
    ++above_;
  } else if (fraction > 0 && fraction < kMicrosecondEnd) {
    ++below_;
    sixteenths_ |= 1U << (fraction * 16 / kMicrosecondEnd);
  }
  spans_seconds_ = spans_seconds_ || (first_second_ && *first_second_ != seconds);
  first_second_ = first_second_.value_or(seconds);
  const bool nano = used() == TimeUnit::kNanoseconds;
  (nano ? used_nano_ : used_micro_) = true;
  return nano ? Duration(fraction) : Duration(std::chrono::microseconds(fraction));
}

bool SubsecondUnit::misread() const {
  return shown() == TimeUnit::kNanoseconds ? used_micro_ : used_nano_;
}

TimeUnit SubsecondUnit::used() const {
  if (known_) {
    return *known_;
  }
  return stated_ == TimeUnit::kMicroseconds ? shown() : stated_;
}

TimeUnit SubsecondUnit::shown() const {
  if (stated_ == TimeUnit::kMicroseconds) {
    return above_ > below_ ? TimeUnit::kNanoseconds : TimeUnit::kMicroseconds;
  }
  const bool are_microseconds = below_ >= kMinValues && below_ > kPerOutlier * above_ &&
                                spans_seconds_ && fills_microseconds();
  return are_microseconds ? TimeUnit::kMicroseconds : TimeUnit::kNanoseconds;
}

// Checked on the circle of a second: recordings begin at any point of it.
bool SubsecondUnit::fills_microseconds() const {
  unsigned empty = 0;
  for (unsigned i = 0; i < 32; ++i) {
    empty = ((sixteenths_ >> (i % 16)) & 1U) != 0 ? 0 : empty + 1;
    if (empty > kMaxEmptySixteenths) {
      return false;
    }
  }
  return true;
}

}  // namespace rayloc::pcap
