#include "daemon/live/cluster/operate/cluster_check.h"

#include <chrono>
#include <iterator>
#include <optional>
#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/operate/node_check.h"
#include "daemon/live/cluster/operate/server_check.h"
#include "daemon/live/cluster/operate/server_greeting.h"
#include "daemon/live/cluster/operate/stream_admin.h"
#include "daemon/live/cluster/operate/stream_check.h"
#include "daemon/live/cluster/operate/worker_check.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/pipeline/record/system_now.h"
#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr std::chrono::milliseconds kGreetingTimeout{2000};  // for a server's greeting

void append(std::vector<Finding>& findings, std::vector<Finding> more) {
  findings.insert(
      findings.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

// Returns nothing if the last batch has expired meanwhile.
std::optional<NodeReport> report_of_node(Broker& broker,
                                         const std::string& stream,
                                         const std::string& subject) {
  const auto stored = last_stored(broker, stream, subject);
  const auto last = broker.last_of(stream, subject);
  NodeReport report;
  if (!stored || !*stored || !last || !*last || !unseal((*last)->data, report.last)) {
    return std::nullopt;
  }
  report.node = token_name(last_token(subject));
  report.stream = stream;
  report.stored = **stored;
  return report;
}

std::vector<Finding> check_nodes(Broker& broker, const std::string& site) {
  std::vector<Finding> findings;
  const std::string stream = csi_stream(site);
  const auto subjects = subjects_of(broker, stream);
  bool has_node = false;
  for (const std::string& subject : subjects ? *subjects : std::vector<std::string>()) {
    if (subject == owner_subject(site)) {
      continue;
    }
    has_node = true;
    if (const auto report = report_of_node(broker, stream, subject)) {
      append(findings, check_node(*report, system_now()));
    }
  }
  if (!has_node) {
    findings.push_back(
        Finding::problem("site " + printable(site) + ": no capture node is sending",
                         "start one with [[source]] site = \"" + printable(site) + "\""));
  }
  return findings;
}

}  // namespace

ServerFindings check_servers(const std::vector<std::string>& servers) {
  ServerFindings checked;
  for (const std::string& server : servers) {
    const auto greeting = greeting_of(server, kGreetingTimeout);
    append(checked.findings, check_server(server, greeting));
    checked.has_several_servers =
        checked.has_several_servers || (greeting && !greeting->cluster.empty());
  }
  return checked;
}

std::vector<Finding> check_cluster(Broker& broker, bool has_several_servers) {
  const auto streams = streams_of(broker);
  if (!streams) {
    return {Finding::problem(streams.error().message)};
  }
  std::vector<Finding> findings;
  const auto store = store_of(broker);
  append(findings,
         store ? check_store(*store) : std::vector{Finding::problem(store.error().message)});
  for (const RequiredStream& required : {required_claim_stream(), required_output_stream()}) {
    append(findings, check_stream(required, *streams, has_several_servers));
  }
  const auto view = inspect_cluster(broker);
  if (!view) {
    findings.push_back(Finding::problem(view.error().message));
    return findings;
  }
  append(findings, check_workers(*view));
  append(findings, check_owners(*view));
  for (const auto& [name, site] : view->sites) {
    append(findings, check_stream(required_csi_stream(name), *streams, has_several_servers));
    append(findings, check_nodes(broker, name));
  }
  return findings;
}

}  // namespace rayloc
