// Which of its sites a worker offers to another, where leaving windows out (shed_rule.h) is not
// enough for long: one that has had too much for a while, if somebody else has room.
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
  // What a worker has to do with: its share of the time of the processors that it may use.
  struct Limits {
    double full = 0.7;  // chosen: from here on another machine may be of help
    double free = 0.4;  // chosen: who has room for one more
    Duration stays = std::chrono::seconds(20);  // chosen: shed for so long, it does not pass
    // Chosen: until what one move has changed can be seen.
    Duration pause = std::chrono::seconds(60);
    // Chosen: a site that came to us is not passed on for so long, or two workers that are both
    // too slow for it would pass it to and fro.
    Duration keeps = std::chrono::minutes(2);
  };

  OverloadRule() = default;
  explicit OverloadRule(const Limits& limits) : limits_(limits) {}

  // `levels`: of what is left out, by site, of all that it owns. `load`: its own. `calmest`: the
  // least of the others who take more and leave nothing out; nothing: there is none.
  std::optional<std::string> site_to_offer(const std::map<std::string, std::uint32_t>& levels,
                                           double load,
                                           std::optional<double> calmest,
                                           Time now);

 private:
  struct Known {
    Time owned;   // since when
    Time shed{};  // since when something is left out; zero: nothing is
  };

  const Limits limits_{};
  std::map<std::string, Known> sites_;
  Time offered_{};  // when the last one was; zero: none
};

}  // namespace rayloc
