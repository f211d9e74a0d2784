#include "daemon/cli/verbs/arguments/survey_ports.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/live/config/config.h"
#include "daemon/live/config/source_url.h"
#include "engine/base/suggestion.h"

namespace rayloc::cli {
namespace {

// Selects the surveyed site of a raylocd: the only site, the named one, or else the one of that
// directory or, if the survey uses another copy of it, of that name.
Expected<SiteSetup> configured_site(const SurveyPortArguments& arguments, const Site& site) {
  auto setup = load_daemon_setup(arguments.config);
  RAYLOC_TRY(setup);
  std::vector<std::function<bool(const SiteSetup&)>> criteria;
  if (arguments.name.empty()) {
    criteria = {[&](const SiteSetup&) { return setup->sites.size() == 1; },
                [&](const SiteSetup& one) {
                  std::error_code ignored;
                  return std::filesystem::equivalent(one.directory, arguments.site, ignored);
                },
                [&](const SiteSetup& one) { return one.site.name == site.name; }};
  } else {
    criteria = {[&](const SiteSetup& one) { return one.site.name == arguments.name; }};
  }
  for (const auto& is_meant : criteria) {
    const auto found = std::find_if(setup->sites.begin(), setup->sites.end(), is_meant);
    if (found != setup->sites.end() &&
        std::none_of(std::next(found), setup->sites.end(), is_meant)) {
      return std::move(*found);
    }
  }
  std::vector<std::string_view> names;
  names.reserve(setup->sites.size());
  for (const SiteSetup& one : setup->sites) {
    names.emplace_back(one.site.name);
  }
  return make_error(
      ErrorKind::kUsage,
      arguments.config +
          ": which of its sites is surveyed? Write --site with one of: " + list_of(names));
}

// Live sources of a site in raylocd's configuration, in the syntax of --listen.
Expected<std::vector<std::string>> configured_ports(const SurveyPortArguments& arguments,
                                                    const Site& site) {
  const auto setup = configured_site(arguments, site);
  RAYLOC_TRY(setup);
  std::vector<std::string> listen;
  for (const SourceConfig& source : setup->config.sources) {
    if (!is_live(source)) {
      return make_error(
          ErrorKind::kUsage,
          source.place + "no live source; write --listen AP=HOST:PORT instead of --config");
    }
    listen.push_back(source.access_point + "=" + source_url(source));
  }
  return listen;
}

}  // namespace

Expected<std::vector<SurveyPort>> survey_ports(const SurveyPortArguments& arguments,
                                               const Site& site) {
  if (arguments.listen.empty() == arguments.config.empty()) {
    return make_error(ErrorKind::kUsage,
                      "state the addresses to which the access points send: --listen "
                      "[AP=]HOST:PORT, or --config raylocd.toml (one of the two)");
  }
  auto listen = arguments.config.empty() ? Expected<std::vector<std::string>>(arguments.listen)
                                         : configured_ports(arguments, site);
  RAYLOC_TRY(listen);
  const auto addresses = resolve_captures(*listen, access_point_ids(site));
  const auto recordings = resolve_captures(arguments.record, access_point_ids(site));
  RAYLOC_TRY(addresses);
  RAYLOC_TRY(recordings);
  std::vector<SurveyPort> ports;
  for (const CaptureArgument& address : *addresses) {
    const auto index = find_access_point(site, address.access_point);
    SurveyPort port{index.value_or(0), address.file, ""};
    for (const CaptureArgument& recording : *recordings) {
      if (recording.access_point == address.access_point) {
        port.recording = recording.file;
      }
    }
    ports.push_back(std::move(port));
  }
  return ports;
}

}  // namespace rayloc::cli
