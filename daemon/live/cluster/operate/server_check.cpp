#include "daemon/live/cluster/operate/server_check.h"

#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "engine/base/printable.h"

namespace rayloc {
namespace {

// Clusters of older servers have lost messages of replicated streams after a node was cut off for 6
// s (2.9.10), or lost streams (until 2.10.22).
constexpr int kGoodMajor = 2;
constexpr int kGoodMinor = 11;

bool is_old_server(const std::string& version) {
  int major = 0;
  int minor = 0;
  return std::sscanf(version.c_str(), "%d.%d", &major, &minor) != 2 ||
         std::pair(major, minor) < std::pair(kGoodMajor, kGoodMinor);
}

}  // namespace

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
  } else if (!greeting->cluster.empty() && is_old_server(greeting->version)) {
    findings.push_back(
        Finding::problem(what + ", a version that may lose messages of replicated streams",
                         fmt::format("install {}.{} or newer", kGoodMajor, kGoodMinor)));
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
