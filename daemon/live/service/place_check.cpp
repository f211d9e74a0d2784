#include "daemon/live/service/place_check.h"

#include <unistd.h>

#include <cerrno>
#include <optional>
#include <string>

#include "daemon/live/http/http_server.h"
#include "daemon/live/publish/socket/endpoint.h"
#include "daemon/live/publish/socket/tcp_listener.h"
#include "daemon/live/service/passed_socket_check.h"
#include "daemon/live/service/sources/source_factory.h"

namespace rayloc {
namespace {

Expected<void> check_endpoint_is_free(const std::string& endpoint) {
  if (ipc_in_use(endpoint)) {
    return tl::make_unexpected(endpoint_error(endpoint, "bind", EADDRINUSE));
  }
  const std::optional<int> fd = listen_on_tcp(endpoint);
  if (fd && *fd < 0) {
    return tl::make_unexpected(endpoint_error(endpoint, "bind", errno));
  }
  if (fd) {
    close(*fd);
  }
  return {};
}

Expected<void> check_http(const HttpConfig& http) {
  HttpServer::Options options;
  options.host = http.host;
  options.port = http.port;
  const auto opened = HttpServer::open(options, {});
  return opened ? Expected<void>() : tl::make_unexpected(opened.error());
}

}  // namespace

Expected<void> check_places(const DaemonConfig& config, const PassedSockets& sockets) {
  for (const auto& [name, endpoint] : {std::pair("publish", &config.publish.endpoint),
                                       std::pair("snapshot", &config.publish.snapshot)}) {
    if (sockets.find(name)) {
      continue;
    }
    RAYLOC_TRY(check_endpoint_is_free(*endpoint));
  }
  for (const SourceConfig& source : config.sources) {
    if (source.kind == SourceKind::kCluster ||
        (takes_socket(source) && sockets.find("source-" + source.instance))) {
      continue;
    }
    RAYLOC_TRY(check_source(source));
  }
  return config.http.enabled && !sockets.find("http") ? check_http(config.http) : Expected<void>();
}

}  // namespace rayloc
