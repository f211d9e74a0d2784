// OneSite: the machines of a cluster with one site and one device: a capture node, two workers, two
// gateways. Checks that the tests of faults share.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/sequencer.h"
#include "rayloc/v1/cluster.pb.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::cluster {

constexpr std::chrono::seconds kPatience{120};

// A raylocd that ends and restarts with the same configuration.
class Machine {
 public:
  Machine(const std::filesystem::path& folder,
          const std::string& name,
          const e2e::LiveDaemonOptions& options);
  e2e::LiveDaemon& first() { return *first_; }
  void signal(int number);
  // Returns the exit status.
  int end(int number);
  void begin();
  std::string errors() const { return again_ ? again_->errors() : first_->errors(); }

 private:
  std::filesystem::path folder_;
  std::unique_ptr<e2e::LiveDaemon> first_;
  std::unique_ptr<e2e::Process> again_;
  int starts_ = 0;
};

class OneSite : public ::testing::Test {
 protected:
  struct Servers {
    std::vector<std::string> urls;
    int replicas = 1;
  };

  // Begins the machines, and waits until the site is located. REQUIRES: the servers run.
  void begin_machines(const Servers& servers);
  virtual std::string standby() const { return "warm"; }

  v1::OutputRecord last_record() const;
  // Waits until the results of all instants before now are published.
  bool goes_on() const;
  // The worker that owns the site, once the broker reports an owner.
  std::string owner() const;
  // Notes how many datagrams the node has captured since its start, once all of them are sent.
  void note_captured();

  // Stops the sender, then the workers.
  void end_machines();
  // For every start of the node, each batch is present or marked, and so are all datagrams that the
  // last start captured. REQUIRES: note_captured().
  void expect_every_datagram();
  // Each owner begins where the one before it ended; no result is published twice.
  void expect_one_story();
  // The witness received the results of a replay, from its first one on, and the other gateway only
  // results of the replay, each once. Returns the results of the replay.
  std::vector<nlohmann::json> expect_published();
  std::vector<nlohmann::json> replay(const std::vector<std::string>& more);

  e2e::TemporaryFolder folder_;
  Servers servers_;
  std::shared_ptr<Broker> broker_;
  std::map<std::string, std::unique_ptr<Machine>> machines_;
  std::unique_ptr<e2e::Process> sender_;

 private:
  e2e::LiveDaemonOptions options_of(const std::string& role, const std::string& name) const;
  std::vector<nlohmann::json> received(const std::string& gateway);

  std::filesystem::path site_;
  std::uint64_t captured_ = 0;
};

}  // namespace rayloc::cluster
