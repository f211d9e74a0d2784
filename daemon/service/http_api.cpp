#include "daemon/service/http_api.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/health/status.h"
#include "daemon/http/map_files.h"
#include "daemon/live_map/playback_control.h"
#include "daemon/publish/json.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

constexpr int kUnavailable = 503;
const char* const kPlain = "text/plain; charset=utf-8";

HttpReply json_of(const google::protobuf::Message& message) {
  const Expected<std::string> json = to_json(message);
  return json ? HttpReply{200, "application/json", *json + "\n"}
              : HttpReply{500, kPlain, json.error().message + "\n"};
}

// An array of messages, one a line.
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

HttpReply healthz(const ServiceHealth& health) {
  if (health.stuck_stages.empty()) {
    return {200, kPlain, "ok\n"};
  }
  std::string names;
  for (const std::string& stage : health.stuck_stages) {
    names += "no progress: " + stage + "\n";
  }
  return {kUnavailable, kPlain, names};
}

HttpReply sources(const StatusMessages& status) {
  JsonArray array;
  for (const v1::SourceState& source : status.sources) {
    array.add(source);
  }
  return array.reply();
}

HttpReply targets(const LastMessages& last) {
  JsonArray array;
  for (const auto& [topic, bytes] : last.matching({"v1/location/"})) {
    v1::Envelope envelope;
    if (envelope.ParseFromString(bytes)) {
      array.add(envelope);
    }
  }
  return array.reply();
}

}  // namespace

std::map<std::string, HttpRoute> http_routes(HttpApi shared) {
  const auto api = std::make_shared<const HttpApi>(std::move(shared));
  std::map<std::string, HttpRoute> routes = map_routes();
  routes["/healthz"] = {[api] { return healthz(api->health()); }, true};
  routes["/readyz"] = {
      [api] {
        const Readiness now = readiness(api->status(), api->health());
        return HttpReply{now.ready() ? 200 : kUnavailable, "application/json", to_json(now)};
      },
      true};
  routes["/metrics"] = {[api] {
                          return HttpReply{200,
                                           "text/plain; version=0.0.4; charset=utf-8",
                                           metrics_text(api->status().heartbeat, api->metrics())};
                        },
                        true};
  routes["/api/v1/status"] = {[api] { return json_of(api->status().heartbeat); }};
  routes["/api/v1/sources"] = {[api] { return sources(api->status()); }};
  routes["/api/v1/targets"] = {[api] { return targets(*api->last); }};
  routes["/api/v1/record/snapshot"] = {[api] { return api->snapshot(); }, false, nullptr, "POST"};
  routes["/api/v1/config"] = {[api] { return HttpReply{200, "application/json", api->config()}; }};
  routes["/api/v1/map"] = {[api] { return HttpReply{200, "application/json", api->map}; }};
  routes["/api/v1/calibration"] = {[api] {
    return HttpReply{200, "application/json", api->calibration};
  }};
  routes["/api/v1/channel"] = {[api] {
    return HttpReply{200, "application/json", api->channel()};
  }};
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
  return routes;
}

}  // namespace rayloc
