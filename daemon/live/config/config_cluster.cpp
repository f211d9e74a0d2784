#include "daemon/live/config/config_cluster.h"

#include <optional>
#include <string>

namespace rayloc {

bool has_no_sources(const TomlTable& root) {
  const std::optional<TomlTable> table = root.has("cluster") ? root.table("cluster") : std::nullopt;
  if (!table || !table->is_string("role")) {
    return false;
  }
  const std::optional<std::string> role = table->string("role");
  return role == "worker" || role == "gateway";
}

void check_cluster(const TomlTable& root, const ClusterConfig& cluster) {
  const std::optional<TomlTable> table = root.table("cluster");
  if (!table || cluster.role == ClusterRole::kNone) {
    return;
  }
  table->require(
      {{"servers", "servers = [\"nats://10.0.0.1:4222\"]"}, {"name", "name = \"hall-1\""}});
  if (cluster.role == ClusterRole::kWorker || cluster.role == ClusterRole::kGateway) {
    const std::string role = table->string("role").value_or("");
    if (root.has("source")) {
      table->error_at(
          "role",
          "'role' is \"" + role + "\", which receives from capture nodes; leave [[source]] out");
    }
    if (!root.is_array("site")) {
      table->error_at("role",
                      "'role' is \"" + role +
                          "\", whose sites come and go; state each as [[site]] with its name");
    }
  }
  if (cluster.name.empty() || cluster.name == "_owner") {
    table->error_at("name", "'name' is '" + cluster.name + "', which no machine may be called");
  }
  if (cluster.servers.empty()) {
    table->error_at("servers", "'servers' names no server; write nats://ADDRESS:PORT");
  }
  for (const std::string& server : cluster.servers) {
    if (server.rfind("nats://", 0) != 0 && server.rfind("tls://", 0) != 0) {
      table->error_at("servers",
                      "'servers': '" + server +
                          "' is no address of a NATS server; write nats://ADDRESS:PORT, or tls://");
      return;
    }
    if (server.find('@') != std::string::npos) {  // the address is shown: no secret belongs in it
      table->error_at("servers", "'servers': an address with a password, which is not supported");
      return;
    }
  }
  if (cluster.tls_cert.empty() != cluster.tls_key.empty()) {
    table->error_at(cluster.tls_cert.empty() ? "tls_key" : "tls_cert",
                    "'tls_cert' and 'tls_key' belong together; state both");
  }
}

}  // namespace rayloc
