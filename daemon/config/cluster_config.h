// [cluster]: the table of many machines on one broker.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/timestamp.h"

namespace rayloc {

enum class ClusterRole { kNone, kCapture, kWorker, kGateway };

// [cluster]: many machines on one broker (daemon/cluster).
struct ClusterConfig {
  ClusterRole role = ClusterRole::kNone;
  std::vector<std::string> servers;  // of NATS
  std::string name;                  // of this machine
  // TLS and who this machine is; empty: as BrokerOptions says.
  std::filesystem::path tls_ca;
  std::filesystem::path tls_cert;
  std::filesystem::path tls_key;
  std::filesystem::path nkey_seed_file;
  Duration flush{};              // the longest that a datagram waits for others of its batch
  std::size_t window_bytes = 0;  // unacknowledged
  Duration keep{};               // what nobody has consumed
  std::size_t keep_bytes = 0;    // of each site
  Duration lease{};              // of a worker that is not heard
  std::size_t capacity = 0;      // sites of a worker at most; 0: any number
  Duration rewarm{};             // what is listened to again at a take-over
  bool is_hot = false;           // a worker computes along for sites that it is next for
  // Of the streams that it makes where there are none.
  bool in_memory = true;
  int replicas = 1;
  std::chrono::seconds retention{};
};

}  // namespace rayloc
