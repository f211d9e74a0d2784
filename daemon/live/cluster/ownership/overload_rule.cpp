#include "daemon/live/cluster/ownership/overload_rule.h"

namespace rayloc {

std::optional<std::string> OverloadRule::site_to_offer(
    const std::map<std::string, std::uint32_t>& levels,
    double load,
    std::optional<double> calmest,
    Time now) {
  std::erase_if(sites_, [&](const auto& one) { return levels.count(one.first) == 0; });
  std::optional<std::string> most;
  for (const auto& [site, level] : levels) {
    Known& known = sites_.try_emplace(site, Known{now}).first->second;
    if (level == 0) {
      known.shed = {};
    } else if (known.shed == Time{}) {
      known.shed = now;
    }
    if (level > 0 && now - known.shed >= limits_.stays && now - known.owned >= limits_.keeps &&
        (!most || level > levels.at(*most))) {
      most = site;
    }
  }
  // The only site of a machine would be as slow on another one.
  if (!most || levels.size() < 2 || load < limits_.full || !calmest || *calmest > limits_.free ||
      (offered_ != Time{} && now - offered_ < limits_.pause)) {
    return std::nullopt;
  }
  offered_ = now;
  return most;
}

}  // namespace rayloc
