// The parts of `rayloc cluster`, each in the file of its name (cluster_doctor.cpp, ...).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "daemon/cli/command/verb.h"
#include "daemon/live/cluster/broker.h"

namespace rayloc::cli {

// The common options: addresses of the servers, and the identity of the client.
std::shared_ptr<BrokerOptions> add_broker_options(OptionParser& sub);
// --tls-ca, --tls-cert, --tls-key, --nkey and --inbox.
void add_identity_options(OptionParser& sub, BrokerOptions& options);
// Returns an Error if no server answers or accepts the client.
Expected<std::shared_ptr<Broker>> connect(const BrokerOptions& options);

Expected<void> run_cluster_doctor(const BrokerOptions& options);

struct ApplyArguments {
  std::string folder;
  std::string name;  // of the site; empty: from site.toml
  int replicas = 1;
};
Expected<void> run_cluster_apply(const BrokerOptions& options, const ApplyArguments& arguments);

struct FetchArguments {
  std::string folder;
  std::string command;  // run after sites have changed; empty: none
  bool keep_on = false;
};
Expected<void> run_cluster_fetch(const BrokerOptions& options, const FetchArguments& arguments);

Expected<void> run_cluster_remove(const BrokerOptions& options, const std::string& site);
// For a site that is applied again: workers may claim it without waiting after its removal.
Expected<void> reopen_claim(Broker& broker, const std::string& site);

}  // namespace rayloc::cli
