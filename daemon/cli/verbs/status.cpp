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

// States of the sites of [[site]], or of the one of [site].
Expected<std::vector<SiteStatus>> ask_all(const HttpQuery& query, const std::string& only) {
  const Expected<JsonResult> sites = get_json(query, "/api/v1/sites");
  RAYLOC_TRY(sites);
  std::vector<SiteStatus> states;
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
    RAYLOC_TRY(state);
    states.push_back(std::move(*state));
  }
  if (states.empty()) {
    return make_error(ErrorKind::kUsage,
                      "no site is called '" + only + "' there; there are: " + names);
  }
  return states;
}

Expected<void> run_status_verb(const HttpOptions& options, const std::string& site, bool json) {
  const Expected<HttpQuery> query = query_of(options);
  RAYLOC_TRY(query);
  const Expected<std::vector<SiteStatus>> states = ask_all(*query, site);
  RAYLOC_TRY(states);
  if (!json) {
    fmt::print("{}", status_text(*states));
    return {};
  }
  for (const SiteStatus& state : *states) {
    fmt::print("{}\n", status_json(state));
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
