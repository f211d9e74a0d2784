// `rayloc status`: state of a running raylocd: readiness, sources, estimates, losses.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/cli/arguments/http_options.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/feed/status_text.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

// `path`: "" or the path of a site, "/site/office".
Expected<SiteStatus> ask(const HttpQuery& query, const std::string& site, const std::string& path) {
  const Expected<JsonResult> ready = get_json(query, path + "/readyz");
  RAYLOC_TRY(ready);
  const Expected<JsonResult> status = get_json(query, path + "/api/v1/status");
  RAYLOC_TRY(status);
  return SiteStatus{site, ready->json, status->json};
}

struct Answers {
  std::vector<SiteStatus> states;
  std::vector<std::string> problems;  // a message for each site without a state
};

// States of the sites of [[site]], or of the one of [site].
Expected<Answers> ask_all(const HttpQuery& query, const std::string& only) {
  const Expected<JsonResult> sites = get_json(query, "/api/v1/sites");
  RAYLOC_TRY(sites);
  Answers answers;
  std::string names;
  for (const nlohmann::json& site : sites->json) {
    const std::string name = site.at("name").get<std::string>();
    names += (names.empty() ? "" : ", ") + name;
    if (!only.empty() && name != only) {
      continue;
    }
    const bool listed = site.at("listed").get<bool>();
    std::string path = "/" + site.at("path").get<std::string>();
    path.pop_back();
    Expected<SiteStatus> state = ask(query, listed ? name : "", listed ? path : "");
    if (state) {
      answers.states.push_back(std::move(*state));
    } else {
      answers.problems.push_back((listed ? "site '" + name + "': " : "") + state.error().message);
    }
  }
  if (answers.states.empty() && answers.problems.empty()) {
    return make_error(ErrorKind::kUsage,
                      "no site is called '" + only + "' there; there are: " + names);
  }
  return answers;
}

Expected<void> run_status_verb(const HttpOptions& options, const std::string& site, bool json) {
  const Expected<HttpQuery> query = query_of(options);
  RAYLOC_TRY(query);
  Expected<Answers> answers = ask_all(*query, site);
  RAYLOC_TRY(answers);
  std::vector<std::string>& problems = answers->problems;
  if (json) {
    for (const SiteStatus& state : answers->states) {
      fmt::print("{}\n", status_json(state));
    }
  } else {
    const StatusText all = status_text(answers->states);
    fmt::print("{}", all.text);
    problems.insert(problems.end(), all.malformed.begin(), all.malformed.end());
  }
  if (!problems.empty()) {
    return make_error(ErrorKind::kUnavailable, fmt::format("{}", fmt::join(problems, "\n")));
  }
  return {};
}

RunVerb declare_status(OptionParser& app) {
  const auto options = add_http_options(app);
  const auto site = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  app.add_option("--site", *site, "Only the site of this name");
  app.add_flag("--json",
               *json,
               "A line of JSON for each site: readiness, the heartbeat as status, and with several "
               "sites the name as site");
  return [options, site, json] { return run_status_verb(*options, *site, *json); };
}

}  // namespace

extern const Verb kStatus;
const Verb kStatus = {"status",
                      "Show how a running raylocd is",
                      "rayloc status --http 127.0.0.1:8480",
                      declare_status};

}  // namespace rayloc::cli
