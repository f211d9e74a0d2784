#include "daemon/live/service/http_api.h"

#include <array>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/live/health/status.h"
#include "daemon/live/http/map_files.h"
#include "daemon/live/live_map/playback_control.h"
#include "daemon/live/studio/studio_routes.h"
#include "daemon/messages/json.h"
#include "daemon/messages/topic.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

constexpr int kServiceUnavailable = 503;
const char* const kPlain = "text/plain; charset=utf-8";

HttpReply json_of(const google::protobuf::Message& message) {
  const Expected<std::string> json = to_json(message);
  return json ? HttpReply{200, "application/json", *json + "\n"}
              : HttpReply{500, kPlain, json.error().message + "\n"};
}

// A JSON array of messages, one per line.
class JsonArray {
 public:
  void add(const google::protobuf::Message& message) {
    if (const Expected<std::string> json = to_json(message)) {
      text_ += (text_.empty() ? "" : ",\n") + *json;
    }
  }
  HttpReply reply() const { return {200, "application/json", "[" + text_ + "]\n"}; }

 private:
  std::string text_;
};

HttpReply refusal(const Error& error) {
  const nlohmann::json json = {{"error", error.message}};
  return {400,
          "application/json",
          json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"};
}

HttpReply healthz(const std::vector<std::string>& stuck_stages) {
  if (stuck_stages.empty()) {
    return {200, kPlain, "ok\n"};
  }
  std::string names;
  for (const std::string& stage : stuck_stages) {
    names += "no progress: " + stage + "\n";
  }
  return {kServiceUnavailable, kPlain, names};
}

HttpReply sources(const StatusMessages& status) {
  JsonArray array;
  for (const v1::SourceState& source : status.sources) {
    array.add(source);
  }
  return array.reply();
}

// `topics`: their prefix. `site`: its component in the topics.
HttpReply targets(const LastMessages& last, std::string topics, const std::string& site) {
  JsonArray array;
  topics += site;
  topics += '/';
  for (const auto& [topic, bytes] : last.matching({std::move(topics)})) {
    v1::Envelope envelope;
    if (envelope.ParseFromString(bytes)) {
      array.add(envelope);
    }
  }
  return array.reply();
}

HttpReply readyz(const Readiness& now) {
  return {now.ready() ? 200 : kServiceUnavailable, "application/json", to_json(now)};
}

HttpReply json_text(std::string text) { return {200, "application/json", std::move(text)}; }

using SitePaths = std::map<std::string, std::string>;  // by the name of the site

// Response to programs that use the paths of a single site, or name another one.
HttpReply ask_a_site(const SitePaths& sites) {
  constexpr int kNotFound = 404;
  nlohmann::ordered_json json = {
      {"error",
       "there are several sites here: /api/v1/sites lists them, and each answers this below "
       "/site/NAME, or with ?site=NAME"},
      {"sites", nlohmann::json::array()}};
  for (const auto& [name, path] : sites) {
    json["sites"].push_back(name);
  }
  return {kNotFound,
          "application/json",
          json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"};
}

constexpr std::array kPathsOfSites = {"/api/v1/status",
                                      "/api/v1/sources",
                                      "/api/v1/targets",
                                      "/api/v1/compared",
                                      "/api/v1/map",
                                      "/api/v1/solid",
                                      "/api/v1/calibration",
                                      "/api/v1/channel",
                                      "/api/v1/presence"};

HttpRoutes routes_of(const std::shared_ptr<const SiteApi>& api) {
  HttpRoutes routes;
  routes["/api/v1/status"] = {[api] { return json_of(api->status().heartbeat); }};
  routes["/api/v1/sources"] = {[api] { return sources(api->status()); }};
  routes["/api/v1/targets"] = {
      [api] { return targets(*api->last, "v1/location/", api->component); }};
  routes["/api/v1/compared"] = {
      [api] { return targets(*api->last, "v1/compared/", api->component); }};
  routes["/api/v1/map"] = {[api] { return json_text(api->map); }};
  routes["/api/v1/solid"] = {[api] { return json_text(api->solid); }};
  routes["/api/v1/calibration"] = {[api] { return json_text(api->calibration); }};
  routes["/api/v1/channel"] = {[api] { return json_text(api->channel()); }};
  routes["/api/v1/presence"] = {[api] { return json_text(api->presence()); }};
  if (api->playback) {
    routes["/api/v1/playback"] = {
        .handler = [api] { return json_of(playback_message(api->playback->state())); },
        .control =
            [api](const HttpParameters& parameters) {
              const Expected<Playback::Change> change =
                  playback_change(parameters, api->playback->state());
              return change ? json_of(playback_message(api->playback->change(*change)))
                            : refusal(change.error());
            }};
  }
  routes["/events"] = {nullptr, false, api->events};
  if (api->editor) {
    routes.merge(editor_routes(api->editor, api->survey, api->plan));
    routes.merge(calibration_routes(api->calibration_job));
  }
  return routes;
}

HttpRoutes routes_of(const DaemonApi& daemon) {
  const auto api = std::make_shared<const DaemonApi>(daemon);
  HttpRoutes routes;
  routes["/healthz"] = {[api] { return healthz(api->stuck_stages()); }, true};
  routes["/readyz"] = {[api] { return readyz(api->readiness()); }, true};
  routes["/metrics"] = {
      [api] {
        return HttpReply{200, "text/plain; version=0.0.4; charset=utf-8", api->metrics()};
      },
      true};
  routes["/api/v1/record/snapshot"] = {[api] { return api->snapshot(); }, false, nullptr, "POST"};
  routes["/api/v1/config"] = {[api] { return json_text(api->config()); }};
  routes["/api/v1/sites"] = {[api] { return json_text(api->sites("")); }};
  return routes;
}

std::string path_of_site(const std::string& component) {
  return "/site/" + decoded_component(component);  // requests are decoded before they are compared
}

// The map of a site that does not run shows the reason, and continues by itself once it runs.
void add_absent(const DaemonApi& daemon,
                const std::string& name,
                const std::string& why,
                HttpRoutes& routes) {
  const std::string path = path_of_site(topic_component(name));
  for (const auto& [map, route] : map_routes()) {
    routes[path + map] = route;
  }
  const nlohmann::json error = {{"error", why}};
  const HttpReply reply{
      kServiceUnavailable,
      "application/json",
      error.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"};
  for (const char* const asked : kPathsOfSites) {
    routes[path + asked] = {[reply] { return HttpReply(reply); }};
  }
  routes[path + "/readyz"] = {[why] { return readyz({{why}, {}}); }, true};
  routes[path + "/api/v1/sites"] = {[ask = daemon.sites] { return json_text(ask("../../")); }};
}

// Adds all paths of a site, with its map, below its own path.
void add_below(const DaemonApi& daemon,
               const std::shared_ptr<const SiteApi>& site,
               HttpRoutes& routes) {
  const std::string path = path_of_site(site->component);
  for (const HttpRoutes& some : {routes_of(site), map_routes()}) {
    for (const auto& [name, route] : some) {
      routes[path + name] = route;
    }
  }
  routes[path + "/readyz"] = {[ask = site->readiness] { return readyz(ask()); }, true};
  routes[path + "/api/v1/sites"] = {[ask = daemon.sites] { return json_text(ask("../../")); }};
}

// A path of sites at the top: it answers for the site that the parameter names.
void add_alias(const std::string& path,
               const std::shared_ptr<const SitePaths>& sites,
               bool changes,
               HttpRoutes& routes) {
  HttpRoute& route = routes[path];
  route.handler = [sites] { return ask_a_site(*sites); };
  if (changes) {
    route.control = [sites](const HttpParameters&) { return ask_a_site(*sites); };
  }
  route.alias = [sites, path](const HttpParameters& parameters) {
    const auto stated = parameters.find("site");
    const auto site = stated == parameters.end() ? sites->end() : sites->find(stated->second);
    return site == sites->end() ? "" : site->second + path;
  };
}

// Adds every path below /api/v1 that a site has and the daemon has not.
void add_aliases(const std::shared_ptr<const SitePaths>& sites, HttpRoutes& routes) {
  std::map<std::string, bool> paths;  // true: a POST changes something
  for (const char* const path : kPathsOfSites) {
    paths[path] = false;
  }
  for (const auto& [name, top] : *sites) {
    const std::string prefix = top + "/api/v1/";
    for (auto at = routes.lower_bound(prefix);
         at != routes.end() && at->first.rfind(prefix, 0) == 0;
         ++at) {
      bool& changes = paths[at->first.substr(top.size())];
      changes = changes || at->second.control || at->second.receive;
    }
  }
  for (const auto& [path, changes] : paths) {
    if (routes.count(path) == 0) {
      add_alias(path, sites, changes, routes);
    }
  }
}

}  // namespace

HttpRoutes single_site_routes(const DaemonApi& daemon, const std::shared_ptr<const SiteApi>& site) {
  HttpRoutes routes = map_routes();
  routes.merge(routes_of(site));
  routes.merge(routes_of(daemon));
  add_below(daemon, site, routes);
  return routes;
}

HttpRoutes site_list_routes(const DaemonApi& daemon,
                            const std::vector<std::shared_ptr<const SiteApi>>& sites,
                            const std::map<std::string, std::string>& absent) {
  HttpRoutes routes = map_routes();
  routes["/"] = routes.at("/map/sites.html");
  routes.merge(routes_of(daemon));
  SitePaths paths;
  for (const auto& site : sites) {
    add_below(daemon, site, routes);
    paths[decoded_component(site->component)] = path_of_site(site->component);
  }
  for (const auto& [name, why] : absent) {
    add_absent(daemon, name, absence(why), routes);
    paths[name] = path_of_site(topic_component(name));
  }
  add_aliases(std::make_shared<const SitePaths>(std::move(paths)), routes);
  return routes;
}

std::string absence(const std::string& why) { return "it has not begun: " + why; }

}  // namespace rayloc
