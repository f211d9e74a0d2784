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

// [cluster]: many machines on one broker (daemon/live/cluster).
struct ClusterConfig {
  ClusterRole role = ClusterRole::kNone;
  std::vector<std::string> servers;  // servers of NATS
  std::string name;                  // name of this machine
  // TLS and the identity of this machine; empty: the defaults of BrokerOptions.
  std::filesystem::path tls_ca;
  std::filesystem::path tls_cert;
  std::filesystem::path tls_key;
  std::filesystem::path nkey_seed_file;
  Duration flush{};              // maximum time that a datagram waits for others of its batch
  std::size_t window_bytes = 0;  // unacknowledged bytes
  Duration keep{};               // retention time of unconsumed messages
  std::size_t keep_bytes = 0;    // maximum for each site
  Duration lease{};              // lease of a worker that sends no messages
  std::size_t capacity = 0;      // maximum number of sites of a worker; 0: any number
  Duration rewarm{};             // period that is read again at a take-over
  bool is_hot = false;           // a worker also computes for sites that it is next in line for
  // Storage of the streams that it creates if there are none.
  bool in_memory = true;
  int replicas = 1;
  std::chrono::seconds retention{};
};

}  // namespace rayloc
