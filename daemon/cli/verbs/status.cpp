// `rayloc status`: state of a running raylocd: readiness, sources, estimates, losses.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/cli/arguments/http_options.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/feed/age_text.h"
#include "daemon/cli/verbs/verbs.h"

namespace rayloc::cli {
namespace {

using StatusJson = nlohmann::json;

// 64-bit numbers are strings in protobuf's JSON.
std::uint64_t count_of(const StatusJson& object, const char* key) {
  const StatusJson value = object.value(key, StatusJson(0));
  return value.is_string() ? std::stoull(value.get<std::string>()) : value.get<std::uint64_t>();
}

std::string lower_tail(const std::string& name, std::size_t prefix) {
  std::string text = name.size() > prefix ? name.substr(prefix) : name;
  for (char& c : text) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

// Parses JSON's "0.023330128s".
double seconds_of(const std::string& duration) { return std::strtod(duration.c_str(), nullptr); }

// Time of the last datagram; a recording's datagrams came long ago, at any time.
std::string last_of(const StatusJson& source) {
  if (source.contains("age")) {
    return age_text(seconds_of(source.at("age").get<std::string>())) + " ago";
  }
  if (count_of(source.at("counters"), "received") == 0) {
    return "no datagram yet";
  }
  return source.at("status") == "SOURCE_STATUS_WAITING" ? "none that is wanted yet"
                                                        : "from a recording";
}

void print_source(const StatusJson& source) {
  const StatusJson& counters = source.at("counters");
  std::uint64_t rejected = 0;
  for (const auto& [reason, count] : counters.at("rejected").items()) {
    rejected += count.is_string() ? std::stoull(count.get<std::string>()) : 0U;
  }
  constexpr std::size_t kPrefix = std::string_view("SOURCE_STATUS_").size();
  const std::uint64_t partial = count_of(counters, "frames_partial");
  fmt::print(
      "{:<12} {:<10} {:>12} datagrams {:>8} frames ({} partial) {:>6} rejected {:>6} lost  {}\n",
      source.at("access_point").get<std::string>(),
      lower_tail(source.at("status").get<std::string>(), kPrefix),
      count_of(counters, "received"),
      count_of(counters, "frames_complete") + partial,
      partial,
      rejected,
      count_of(counters, "kernel_drops") + count_of(counters, "ring_dropped") +
          count_of(counters, "late") + count_of(counters, "frames_dropped"),
      last_of(source));
}

// Number of tracks; people are included if the site locates them with a measured empty room.
std::string tracks_of(const StatusJson& status) {
  std::string text = fmt::format("{} tracks of devices",
                                 count_of(status.value("tracker", StatusJson::object()), "tracks"));
  if (status.contains("person_tracker")) {
    text += fmt::format(", {} of people", count_of(status.at("person_tracker"), "tracks"));
  }
  return text;
}

// "2026-11-26T22:00:00.123456789Z" without the fraction.
std::string to_the_second(const std::string& time) {
  const std::size_t point = time.find('.');
  return point == std::string::npos ? time : time.substr(0, point) + "Z";
}

// Publisher state, shared by all sites.
std::string publisher_of(const StatusJson& status) {
  const StatusJson& publisher = status.at("publisher");
  return fmt::format("{} messages to {} subscriptions, {} times one was slow",
                     count_of(publisher, "published"),
                     count_of(publisher, "subscriptions"),
                     count_of(publisher, "slow_episodes"));
}

// `end`: end of the last line.
void print_state(const StatusJson& ready, const StatusJson& status, const std::string& end) {
  fmt::print("raylocd {} since {}: {}\n",
             status.at("software_version").get<std::string>(),
             to_the_second(status.at("started").get<std::string>()),
             ready.at("ready").get<bool>() ? "ready" : "not ready");
  for (const StatusJson& reason : ready.at("reasons")) {
    fmt::print("  {}\n", reason.get<std::string>());
  }
  for (const StatusJson& warning : ready.at("warnings")) {
    fmt::print("  warning: {}\n", warning.get<std::string>());
  }
  if (ready.value("clock", "") == "unknown") {
    fmt::print("  clock: synchronisation unknown to raylocd; timedatectl shows it\n");
  }
  for (const StatusJson& source : status.at("sources")) {
    print_source(source);
  }
  const StatusJson& estimation = status.at("estimation");
  fmt::print(
      "{} fixes, {} without a position, {}; {} bursts gave way to newer ones, {} were left out{}\n",
      count_of(estimation, "fixes"),
      count_of(estimation, "no_fixes"),
      tracks_of(status),
      count_of(estimation, "bursts_merged"),
      count_of(estimation, "bursts_dropped"),
      end);
  for (const StatusJson& compared : status.value("compared", StatusJson::array())) {
    fmt::print("compared {}: {} fixes, {} without a position; {} bursts dropped\n",
               compared.value("method", ""),
               count_of(compared, "fixes"),
               count_of(compared, "no_fixes"),
               count_of(compared, "bursts_dropped"));
  }
  const StatusJson reloads = status.value("reloads", StatusJson::object());
  if (count_of(reloads, "exchanges") > 0) {
    fmt::print("prepared anew {} times since the start: {} datagrams lost, {} frames left\n",
               count_of(reloads, "exchanges"),
               count_of(reloads, "datagrams_lost"),
               count_of(reloads, "frames_left"));
  }
}

struct State {
  std::string site;  // empty: the only site
  StatusJson readiness;
  StatusJson status;  // an error if the site never started
  bool has_begun() const { return status.contains("sources"); }
};

// `path`: "" or the path of a site, "/site/office".
Expected<State> ask(const HttpQuery& query, const std::string& site, const std::string& path) {
  const Expected<JsonResult> ready = get_json(query, path + "/readyz");
  if (!ready) {
    return tl::make_unexpected(ready.error());
  }
  const Expected<JsonResult> status = get_json(query, path + "/api/v1/status");
  if (!status) {
    return tl::make_unexpected(status.error());
  }
  return State{site, ready->json, status->json};
}

// States of the sites of [[site]], or of the one of [site].
Expected<std::vector<State>> ask_all(const HttpQuery& query, const std::string& only) {
  const Expected<JsonResult> sites = get_json(query, "/api/v1/sites");
  if (!sites) {
    return tl::make_unexpected(sites.error());
  }
  std::vector<State> states;
  std::string names;
  for (const StatusJson& site : sites->json) {
    const std::string name = site.at("name").get<std::string>();
    names += (names.empty() ? "" : ", ") + name;
    if (!only.empty() && name != only) {
      continue;
    }
    const bool listed = site.at("listed").get<bool>();
    std::string path = "/" + site.at("path").get<std::string>();
    path.pop_back();
    Expected<State> state = ask(query, listed ? name : "", listed ? path : "");
    if (!state) {
      return tl::make_unexpected(state.error());
    }
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
  if (!query) {
    return tl::make_unexpected(query.error());
  }
  const Expected<std::vector<State>> states = ask_all(*query, site);
  if (!states) {
    return tl::make_unexpected(states.error());
  }
  for (const State& state : *states) {
    if (json) {
      StatusJson line = {{"readiness", state.readiness}, {"status", state.status}};
      if (!state.site.empty()) {
        line["site"] = state.site;
      }
      fmt::print("{}\n", line.dump());
      continue;
    }
    if (state.site.empty()) {
      print_state(state.readiness, state.status, "; " + publisher_of(state.status));
      continue;
    }
    fmt::print("{}site {}\n", &state == &states->front() ? "" : "\n", state.site);
    if (state.has_begun()) {
      print_state(state.readiness, state.status, "");
    } else {
      fmt::print("not ready: {}\n", state.status.value("error", "it states no reason"));
    }
  }
  const auto some = std::find_if(states->begin(), states->end(), [](const State& state) {
    return !state.site.empty() && state.has_begun();
  });
  if (!json && some != states->end()) {
    fmt::print("\n{}\n", publisher_of(some->status));
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
