#include "daemon/live/cluster/operate/server_check.h"

#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/base/printable.h"

namespace rayloc {

bool is_too_old_for_clusters(const std::string& version) {
  std::array<int, 3> numbers{};
  return std::sscanf(version.c_str(), "%d.%d.%d", &numbers[0], &numbers[1], &numbers[2]) != 3 ||
         numbers < kClusterServer;
}

std::vector<Finding> check_server(const std::string& server,
                                  const Expected<ServerGreeting>& greeting) {
  if (!greeting) {
    return {Finding::problem("server " + printable(greeting.error().message),
                             "check that it runs: systemctl status nats-server")};
  }
  std::vector<Finding> findings;
  const std::string what =
      "server " + server + ": nats-server " + printable(greeting->version) +
      (greeting->cluster.empty() ? ", not in a cluster"
                                 : ", in cluster " + printable(greeting->cluster));
  if (!greeting->jetstream) {
    findings.push_back(
        Finding::problem(what + ", without JetStream", "add jetstream { } to nats.conf"));
  } else if (!greeting->cluster.empty() && is_too_old_for_clusters(greeting->version)) {
    findings.push_back(Finding::problem(
        what + ", a version that may lose or withhold messages of replicated streams",
        fmt::format("install {} or newer", fmt::join(kClusterServer, "."))));
  } else {
    findings.push_back(Finding::ok(what));
  }
  if (!greeting->asks_who || !greeting->asks_for_tls) {
    findings.push_back(Finding::warning(
        "server " + server + ": " +
            (greeting->asks_who       ? "the traffic is not encrypted"
             : greeting->asks_for_tls ? "clients need no credentials"
                                      : "clients need no credentials, and the "
                                        "traffic is not encrypted"),
        "configure it as in deploy/cluster/nats.conf, unless its network is isolated"));
  }
  return findings;
}

}  // namespace rayloc
