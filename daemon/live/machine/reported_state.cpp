#include "daemon/live/machine/reported_state.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/live/machine/source_hints.h"
#include "daemon/messages/json.h"

namespace rayloc {
namespace {

// Adds the entries of a /readyz list, except those that have been found here as well.
void add_reported(const nlohmann::json& list,
                  Finding::Kind kind,
                  const std::function<bool(const std::string&)>& is_known,
                  std::vector<Finding>& findings) {
  for (const nlohmann::json& one : list) {
    const std::string words = one.get<std::string>();
    const bool is_found = std::any_of(
        findings.begin(), findings.end(), [&](const Finding& f) { return f.what == words; });
    if (!is_found && !is_known(words)) {
      findings.push_back({kind, "raylocd: " + words, ""});
    }
  }
}

}  // namespace

std::vector<Finding> source_findings(const nlohmann::json& sources, const Site& site) {
  std::vector<Finding> findings;
  for (const nlohmann::json& source : sources) {
    v1::SourceState state;
    if (from_json(source.dump(), state)) {
      for (Finding& hint : source_hints(state, site)) {
        findings.push_back(std::move(hint));
      }
    }
  }
  return findings;
}

void add_readiness(const nlohmann::json& ready, bool has_sources, std::vector<Finding>& findings) {
  const nlohmann::json none = nlohmann::json::array();
  const auto is_of_source = [&](const std::string& words) {
    return has_sources && words.rfind("source ", 0) == 0;
  };
  add_reported(ready.value("reasons", none), Finding::Kind::kProblem, is_of_source, findings);
  const auto is_of_clock = [](const std::string& words) {
    return words.rfind("the clock ", 0) == 0;
  };
  add_reported(ready.value("warnings", none), Finding::Kind::kWarning, is_of_clock, findings);
}

Finding silent_daemon(pid_t process, bool has_http) {
  const std::string what = "raylocd runs with this file as process " + std::to_string(process);
  return has_http ? Finding{Finding::Kind::kWarning,
                            what + " and does not answer yet: it is starting, or stopping",
                            "try again when its log reports that it is running"}
                  : Finding{Finding::Kind::kOk,
                            what + ", and does not report its sources: [http] is not enabled",
                            ""};
}

}  // namespace rayloc
