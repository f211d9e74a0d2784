// `rayloc cluster doctor`: reports the problems of a cluster
// with a remedy for each. It only reads and changes nothing.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/cli/verbs/cluster_verbs.h"
#include "daemon/cli/verbs/findings.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/operate/server_greeting.h"
#include "daemon/live/cluster/operate/stream_admin.h"
#include "daemon/live/cluster/sealed_message.h"
#include "daemon/pipeline/record/system_now.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

using Kind = Finding::Kind;
using std::chrono::milliseconds;
using Findings = std::vector<Finding>;

constexpr milliseconds kGreetingTimeout{2000};  // for a server's greeting
// Clusters of older servers have lost messages of replicated streams after a node was cut off for 6
// s (2.9.10), or lost streams (until 2.10.22).
constexpr int kGoodMajor = 2;
constexpr int kGoodMinor = 11;
constexpr double kClocksApart = 0.1;  // s: above the transit time of a message
constexpr double kSilent = 5.0;       // s; a capture node sends ten signs of life a second
constexpr double kNearlyFull = 0.8;   // share of the account's storage limit

bool is_old(const std::string& version) {
  int major = 0;
  int minor = 0;
  return std::sscanf(version.c_str(), "%d.%d", &major, &minor) != 2 ||
         std::pair(major, minor) < std::pair(kGoodMajor, kGoodMinor);
}

// True if the server is one of several.
bool check_server(const std::string& server, Findings& findings) {
  const auto greeting = greeting_of(server, kGreetingTimeout);
  if (!greeting) {
    findings.push_back({Kind::kProblem,
                        "server " + printable(greeting.error().message),
                        "see whether it runs: systemctl status nats-server"});
    return false;
  }
  const std::string what =
      "server " + server + ": nats-server " + printable(greeting->version) +
      (greeting->cluster.empty() ? ", alone" : ", of cluster " + printable(greeting->cluster));
  if (!greeting->jetstream) {
    findings.push_back(
        {Kind::kProblem, what + ", without JetStream", "write jetstream { } into nats.conf"});
  } else if (!greeting->cluster.empty() && is_old(greeting->version)) {
    findings.push_back({Kind::kProblem,
                        what + ", which may lose messages of replicated streams",
                        fmt::format("install {}.{} or newer", kGoodMajor, kGoodMinor)});
  } else {
    findings.push_back({Kind::kOk, what, ""});
  }
  if (!greeting->asks_who || !greeting->asks_for_tls) {
    findings.push_back({Kind::kWarning,
                        "server " + server + " takes everybody" +
                            (greeting->asks_for_tls ? "" : ", and nothing is encrypted"),
                        "see deploy/cluster/nats.conf, unless its network is its own"});
  }
  return !greeting->cluster.empty();
}

// A stream that every cluster has, or a stream of a site.
struct Wanted {
  std::string name;
  std::string republish_to;
  std::int64_t messages_per_subject = 0;
};

void check_stream(const Wanted& wanted,
                  const std::vector<StreamReport>& streams,
                  bool servers_are_several,
                  Findings& findings) {
  const std::string what = "stream " + wanted.name;
  for (const StreamReport& stream : streams) {
    if (stream.options.name != wanted.name) {
      continue;
    }
    for (const std::string& trouble : stream.troubles) {
      findings.push_back({Kind::kProblem,
                          what + ": " + printable(trouble),
                          "wait for that server, or take it out of the cluster"});
    }
    if (!stream.answers_directly || stream.options.republish_to != wanted.republish_to ||
        stream.options.max_messages_per_subject != wanted.messages_per_subject) {
      findings.push_back({Kind::kProblem,
                          what + " was not made by raylocd: workers cannot read it",
                          "delete it (nats stream rm " + wanted.name +
                              "); raylocd makes it again when it needs it"});
    } else if (servers_are_several && stream.options.replicas == 1) {
      findings.push_back({Kind::kWarning,
                          what + " is on one server alone",
                          "set replicas = 3 in [cluster], and nats stream edit --replicas 3"});
    } else if (stream.troubles.empty()) {
      findings.push_back({Kind::kOk,
                          fmt::format("{}: {} replicas in {}",
                                      what,
                                      stream.options.replicas,
                                      stream.options.in_memory ? "memory" : "files"),
                          ""});
    }
    return;
  }
  findings.push_back({Kind::kProblem, what + " is not there", "start a worker, which makes it"});
}

void check_store(Broker& broker, Findings& findings) {
  const auto store = store_of(broker);
  if (!store) {
    findings.push_back({Kind::kProblem, store.error().message, ""});
    return;
  }
  const auto check = [&](const char* what, std::uint64_t used, std::int64_t most) {
    if (most > 0 && static_cast<double>(used) > kNearlyFull * static_cast<double>(most)) {
      findings.push_back({Kind::kWarning,
                          fmt::format("streams in {} take {} MiB of {}",
                                      what,
                                      used >> 20U,
                                      static_cast<std::uint64_t>(most) >> 20U),
                          "raise the limit in jetstream { }, or lower retention_s"});
    }
  };
  check("memory", store->memory, store->most_memory);
  check("files", store->files, store->most_files);
}

// Checks the last batch of a capture node.
void check_node(Broker& broker,
                const std::string& stream,
                const std::string& subject,
                Findings& findings) {
  const auto stored = last_stored(broker, stream, subject);
  const auto last = broker.last_of(stream, subject);
  v1::CsiBatch batch;
  if (!stored || !*stored || !last || !*last || !unseal((*last)->data, batch)) {
    return;  // its last batch has expired meanwhile
  }
  const std::string what =
      "capture node " + printable(token_name(last_token(subject))) + " of " + stream;
  const double age = to_seconds(system_now() - **stored);
  if (age > kSilent) {
    findings.push_back({Kind::kProblem,
                        fmt::format("{} is silent for {:.0f} s", what, age),
                        "see whether raylocd runs there and reaches the servers"});
  } else if (!batch.clock_synchronised()) {
    findings.push_back({Kind::kWarning,
                        what + ": its clock is not synchronised",
                        "run chrony or systemd-timesyncd there"});
  } else {
    findings.push_back({Kind::kOk, what + " sends", ""});
  }
  for (const v1::ApPart& part : batch.parts()) {
    const Timestamp watermark{std::chrono::microseconds(part.watermark_us())};
    if (const double ahead = to_seconds(watermark - **stored); ahead > kClocksApart) {
      findings.push_back({Kind::kProblem,
                          fmt::format("{}: its clock is {:.2f} s before the server's", what, ahead),
                          "set both by NTP"});
      return;
    }
  }
}

void check_nodes(Broker& broker, const std::string& site, Findings& findings) {
  const std::string stream = csi_stream(site);
  const auto subjects = subjects_of(broker, stream);
  bool has_node = false;
  for (const std::string& subject : subjects ? *subjects : std::vector<std::string>()) {
    if (subject != owner_subject(site)) {
      has_node = true;
      check_node(broker, stream, subject, findings);
    }
  }
  if (!has_node) {
    findings.push_back({Kind::kProblem,
                        "site " + printable(site) + ": no capture node sends",
                        "start one with [[source]] site = \"" + printable(site) + "\""});
  }
}

void check_worker(const ClusterView::Worker& worker, Findings& findings) {
  const v1::WorkerState& state = worker.state;
  const std::string what =
      fmt::format("worker {}: {} sites", printable(state.worker()), state.sites_size());
  const Timestamp reported{std::chrono::microseconds(state.now_us())};
  const double apart = to_seconds(worker.received - reported);
  if (state.now_us() != 0 && std::abs(apart) > kClocksApart) {
    findings.push_back({Kind::kWarning,
                        fmt::format("{}: its clock is {:.2f} s {} ours",
                                    what,
                                    std::abs(apart),
                                    apart > 0 ? "behind" : "before"),
                        "set both by NTP"});
  } else if (state.shedding() > 0) {
    findings.push_back(
        {Kind::kWarning,
         fmt::format("{}, behind with {}: windows of them are left out", what, state.shedding()),
         "add a worker, or lower its capacity"});
  } else if (state.leaving()) {
    findings.push_back({Kind::kWarning, what + ", it takes no more", "start it anew when ready"});
  } else {
    const bool is_full =
        state.capacity() > 0 && static_cast<std::uint32_t>(state.sites_size()) >= state.capacity();
    findings.push_back({is_full ? Kind::kWarning : Kind::kOk,
                        what + (is_full ? ", as many as it takes" : ""),
                        is_full ? "raise capacity, or add a worker" : ""});
  }
}

void check_workers(const ClusterView& view, Findings& findings) {
  std::set<std::string> arithmetic;
  std::set<std::uint32_t> leases;
  for (const auto& [name, worker] : view.workers) {
    check_worker(worker, findings);
    arithmetic.insert(worker.state.arithmetic());
    leases.insert(worker.state.lease_ms());
  }
  if (view.workers.empty()) {
    findings.push_back({Kind::kProblem, "no worker reports", "start a raylocd with role worker"});
  }
  if (arithmetic.size() > 1) {
    findings.push_back({Kind::kWarning,
                        "workers compute with other instructions (`rayloc cluster status`)",
                        "results differ in their last digits after a take-over"});
  }
  if (leases.size() > 1) {
    findings.push_back(
        {Kind::kProblem, "workers have other leases", "set the same lease_s for all"});
  }
}

void check_sites(const ClusterView& view, Findings& findings) {
  for (const auto& [name, site] : view.sites) {
    if (!view.has_owner(site.claim)) {
      findings.push_back({Kind::kProblem,
                          "site " + printable(name) + " has no worker",
                          "start one that has this [[site]] and room for it"});
    } else {
      findings.push_back({Kind::kOk,
                          "site " + printable(name) + ": worker " + printable(site.claim.worker()),
                          ""});
    }
  }
}

Expected<void> inspect_broker(Broker& broker, bool servers_are_several, Findings& findings) {
  const auto streams = streams_of(broker);
  if (!streams) {
    return tl::make_unexpected(streams.error());
  }
  check_store(broker, findings);
  check_stream({std::string(kClaimStream), std::string(kClaimsAgain), 1},
               *streams,
               servers_are_several,
               findings);
  check_stream({std::string(kOutputStream), std::string(kOutputAgain), 0},
               *streams,
               servers_are_several,
               findings);
  const auto view = inspect_cluster(broker);
  if (!view) {
    return tl::make_unexpected(view.error());
  }
  check_workers(*view, findings);
  check_sites(*view, findings);
  for (const auto& [name, site] : view->sites) {
    check_stream(
        {csi_stream(name), live_subjects(name), 0}, *streams, servers_are_several, findings);
    check_nodes(broker, name, findings);
  }
  return {};
}

}  // namespace

Expected<void> run_cluster_doctor(const BrokerOptions& options) {
  Findings findings;
  bool servers_are_several = false;
  for (const std::string& server : options.servers) {
    servers_are_several = check_server(server, findings) || servers_are_several;
  }
  const auto broker = connect(options);
  const Expected<void> inspected = broker ? inspect_broker(**broker, servers_are_several, findings)
                                          : tl::make_unexpected(broker.error());
  if (!inspected) {
    findings.push_back({Kind::kProblem, inspected.error().message, ""});
  }
  return print_findings(findings);
}

}  // namespace rayloc::cli
