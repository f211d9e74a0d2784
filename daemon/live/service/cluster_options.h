// From [cluster] to the options of a cluster's parts.
#pragma once

#include <algorithm>
#include <chrono>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/config/config.h"

namespace rayloc {

inline BrokerOptions broker_options(const ClusterConfig& config) {
  BrokerOptions options{config.servers, "raylocd " + config.name};
  options.inbox = subject_token(config.name);
  options.ca_file = config.tls_ca.string();
  options.certificate_file = config.tls_cert.string();
  options.key_file = config.tls_key.string();
  options.nkey_seed_file = config.nkey_seed_file.string();
  return options;
}

// Options for creating a stream that does not exist yet.
inline StreamOptions stream_options(const ClusterConfig& config) {
  StreamOptions options;
  options.in_memory = config.in_memory;
  options.replicas = config.replicas;
  options.max_age = config.retention;
  return options;
}

// The same for the stream of results, which is small and outlives its servers.
inline StreamOptions result_options(const ClusterConfig& config) {
  constexpr std::chrono::minutes kKeep{10};  // for gateways that were absent, and for replays
  StreamOptions options = stream_options(config);
  options.in_memory = false;
  options.max_age = std::max<std::chrono::seconds>(config.retention, kKeep);
  return options;
}

}  // namespace rayloc
