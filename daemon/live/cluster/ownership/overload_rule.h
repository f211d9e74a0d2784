// Rule that selects a site to offer to another worker, where leaving windows out (shed_rule.h)
// is not enough: one that was overloaded for a while, if another worker has capacity.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "engine/base/timestamp.h"

namespace rayloc {

class OverloadRule {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // Loads of workers: the used share of the processor time that they may use.
  struct Limits {
    double full = 0.7;                          // chosen: from here on another machine may help
    double free = 0.4;                          // chosen: capacity for one more site
    Duration stays = std::chrono::seconds(20);  // chosen: shedding for so long is not temporary
    // Chosen: until the effect of one move is visible.
    Duration pause = std::chrono::seconds(60);
    // Chosen: minimum time until a received site is passed on; otherwise two
    // workers that are both too slow for it would exchange it repeatedly.
    Duration keeps = std::chrono::minutes(2);
  };

  OverloadRule() = default;
  explicit OverloadRule(const Limits& limits) : limits_(limits) {}

  // `levels`: shedding levels, by site, of all owned sites. `load`: of this worker. `calmest`:
  // the least load of the others that take more sites and leave nothing out; nothing: none.
  std::optional<std::string> site_to_offer(const std::map<std::string, std::uint32_t>& levels,
                                           double load,
                                           std::optional<double> calmest,
                                           Time now);

 private:
  struct Known {
    Time owned;   // start of ownership
    Time shed{};  // start of shedding; zero: no shedding
  };

  const Limits limits_{};
  std::map<std::string, Known> sites_;
  Time offered_{};  // time of the last offer; zero: none
};

}  // namespace rayloc
