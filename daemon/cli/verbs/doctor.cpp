// `rayloc doctor FILE`: reports the problems of this machine for the daemon that the file
// describes.
//
// It only reads and changes nothing. One line per finding: ok, warning or problem, with a remedy.
// The exit status is 69 if there is a problem.
#include <unistd.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/arguments/http_options.h"
#include "daemon/cli/command/file_error.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/report/findings.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/live/config/config.h"
#include "daemon/live/health/readiness.h"
#include "daemon/live/machine/machine_check.h"
#include "daemon/live/machine/reported_state.h"
#include "daemon/live/machine/running_daemon.h"
#include "daemon/site/model/room_model.h"

namespace rayloc::cli {
namespace {

// Gets the sources from a running daemon. Returns false without them (a token is required).
bool ask_for_sources(const HttpQuery& query, const Site& site, std::vector<Finding>& findings) {
  const Expected<JsonResult> sources = get_json(query, "/api/v1/sources");
  if (!sources) {
    findings.push_back({Finding::Kind::kWarning,
                        "raylocd does not report its sources: " + sources.error().message,
                        "pass its token: --token-file"});
    return false;
  }
  for (Finding& fault : source_findings(sources->json, site)) {
    findings.push_back(std::move(fault));
  }
  return true;
}

// Adds a finding for each thing that the site lacks for localization.
void check_site_setup(const SiteSetup& setup, std::vector<Finding>& findings) {
  const Expected<RoomModel> room = load_room_model(setup.site);
  if (!room) {
    findings.push_back({Finding::Kind::kProblem, room.error().message, ""});
    return;
  }
  const SiteLacks lacks = lacks_of(setup, *room);
  for (const std::string& obstacle : lacks.obstacles) {
    findings.push_back({Finding::Kind::kProblem, obstacle, ""});
  }
  for (const std::string& warning : lacks.warnings) {
    findings.push_back({Finding::Kind::kWarning, warning, ""});
  }
}

// Adds the state of a running daemon; no finding if none answers (its ports are checked
// separately). With several sites, sources are not queried.
void ask_daemon(const HttpQuery& query,
                const Site& site,
                bool has_site_list,
                std::vector<Finding>& findings) {
  const Expected<JsonResult> ready = get_json(query, "/readyz");
  if (!ready) {
    return;
  }
  const bool has_sources = !has_site_list && ask_for_sources(query, site, findings);
  add_readiness(ready->json, has_sources, findings);
}

// Uses the address and token of the configuration file unless the options override them. An
// unreadable token is a finding of check_machine() and does not end the verb.
Expected<HttpQuery> query_of(HttpOptions options, const HttpConfig& config) {
  if (options.address.empty()) {
    const bool is_any_address = config.host == "0.0.0.0";
    options.address = (is_any_address ? std::string("127.0.0.1") : config.host) + ":" +
                      std::to_string(config.port);
  }
  if (options.token_file.empty() && access(config.token_file.c_str(), R_OK) == 0) {
    options.token_file = config.token_file.string();
  }
  return query_of(options);
}

Expected<void> run_doctor(const std::string& file, const HttpOptions& options) {
  const Expected<DaemonSetup> setup = load_daemon_setup(file);
  if (!setup) {
    return report_file_error({ErrorKind::kConfiguration, setup.error().message});
  }
  const Expected<HttpQuery> query = query_of(options, setup->config.http);
  RAYLOC_TRY(query);
  const bool asked = setup->config.http.enabled || !options.address.empty();
  const bool answers = asked && http_get(*query, "/healthz").has_value();
  const std::optional<pid_t> silent = answers ? std::nullopt : running_daemon(file);
  std::vector<Finding> findings = check_machine(setup->config, answers || silent);
  if (silent) {
    findings.push_back(silent_daemon(*silent, setup->config.http.enabled));
  }
  for (const SiteSetup& site : setup->sites) {
    check_site_setup(site, findings);
  }
  if (answers) {
    ask_daemon(*query, setup->sites.front().site, setup->config.has_site_list, findings);
  }
  return print_findings(findings);
}

RunVerb declare_doctor(OptionParser& app) {
  const auto file = std::make_shared<std::string>("/etc/raylocd/raylocd.toml");
  app.add_option("FILE", *file, "raylocd.toml")->capture_default_str();
  const auto options = add_http_options(app, "");
  app.get_option("--http")->description("HOST:PORT of raylocd's HTTP; default: [http] of FILE");
  app.get_option("--token-file")
      ->description("File with the token; default: [http] token_file of FILE");
  return [file, options] { return run_doctor(*file, *options); };
}

}  // namespace

extern const Verb kDoctor;
const Verb kDoctor = {"doctor",
                      "Find problems of this machine that disturb raylocd",
                      "rayloc doctor /etc/raylocd/raylocd.toml",
                      declare_doctor};

}  // namespace rayloc::cli
