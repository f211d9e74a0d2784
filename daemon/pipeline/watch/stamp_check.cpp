#include "daemon/pipeline/watch/stamp_check.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

namespace rayloc {
namespace {

bool is_whole_second(Timestamp time) {
  return time.time_since_epoch() % std::chrono::seconds(1) == Duration::zero();
}

bool is_wrong(const StuckStamp& stamp) {
  return stamp.is_stuck() || (stamp.frames >= kFramesOfASecond && is_whole_second(stamp.time));
}

std::string stamp_text(Timestamp time) {
  const auto nanoseconds = time.time_since_epoch().count();
  return fmt::format("{}.{:06}", nanoseconds / 1'000'000'000, nanoseconds / 1'000 % 1'000'000);
}

}  // namespace

std::optional<StuckStamp> stuck_stamp(std::span<const CsiFrame> frames) {
  std::map<std::pair<std::size_t, Timestamp>, std::size_t> counts;
  for (const CsiFrame& frame : frames) {
    ++counts[{frame.access_point, frame.time}];
  }
  StuckStamp worst;
  for (const auto& [stamp, count] : counts) {
    if (const StuckStamp one{stamp.first, stamp.second, count};
        is_wrong(one) && count > worst.frames) {
      worst = one;
    }
  }
  return worst.frames > 0 ? std::optional(worst) : std::nullopt;
}

std::string describe(const StuckStamp& stamp) {
  return stamp.is_stuck() ? "time stamps do not advance"
                          : "time stamps advance by whole seconds only";
}

void StampTally::add(std::span<const Datagram> datagrams) {
  for (const Datagram& datagram : datagrams) {
    run_ = records_ > 0 && datagram.time == record_ ? run_ + 1 : 1;
    longest_run_ = std::max(longest_run_, run_);
    record_ = datagram.time;
    ++records_;
  }
}

void StampTally::add(std::span<const CsiFrame> frames) {
  for (const CsiFrame& frame : frames) {
    if (stamps_ == 0 || frame.time != frame_) {
      of_stamp_.clear();
      frame_ = frame.time;
      ++stamps_;
    }
    const StuckStamp now{frame.access_point, frame.time, ++of_stamp_[frame.transmitter]};
    if (now.frames > worst_.frames && is_wrong(now)) {
      worst_ = now;
    }
    whole_seconds_ += now.frames == kFramesOfASecond && is_whole_second(now.time) ? 1U : 0U;
  }
}

std::string StampTally::text() const {
  if (!worst_.is_stuck() && 2 * whole_seconds_ <= stamps_) {
    return {};
  }
  return fmt::format(
      "{}: up to {} of {} records share one, and {} frames have {}; such frames give no position: "
      "record with time stamps of microseconds",
      describe(worst_),
      longest_run_,
      records_,
      worst_.frames,
      stamp_text(worst_.time));
}

}  // namespace rayloc
