#include "daemon/live/cluster/shed_rule.h"

namespace rayloc {
namespace {

// Length of two bursts: one of them is complete.
constexpr Duration kWindow = std::chrono::milliseconds(400);

}  // namespace

bool is_used(Timestamp time, std::uint32_t level) {
  const auto window = std::chrono::floor<std::chrono::microseconds>(time.time_since_epoch()) /
                      std::chrono::duration_cast<std::chrono::microseconds>(kWindow);
  return window % (std::int64_t{1} << level) == 0;
}

std::optional<std::uint32_t> ShedRule::next_level(Timestamp received,
                                                  Timestamp done,
                                                  std::uint32_t level,
                                                  Time now) {
  if (received == Timestamp::min() || done == Timestamp::min()) {
    return std::nullopt;
  }
  const Duration lag = received - done;
  const Load load = lag > limits_.most_lag    ? Load::kTooMuch
                    : lag < limits_.least_lag ? Load::kLittle
                                              : Load::kUsual;
  if (load != load_) {
    load_ = load;
    since_ = now;
  }
  const bool is_more = load == Load::kTooMuch && level < kMaxShed;
  const bool is_less = load == Load::kLittle && level > 0;
  if ((!is_more && !is_less) || now - since_ < limits_.patience) {
    return std::nullopt;
  }
  since_ = now;
  return is_more ? level + 1 : level - 1;
}

}  // namespace rayloc
