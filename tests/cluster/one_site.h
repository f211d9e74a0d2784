// OneSite: the machines of a cluster about one site, while a device is heard there: a capture node,
// two workers, two gateways. What tests of faults want to see of them afterwards.
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

#include "daemon/cluster/broker.h"
#include "daemon/cluster/sequencer.h"
#include "rayloc/v1/cluster.pb.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::cluster {

constexpr std::chrono::seconds kPatience{120};

// A raylocd that ends and begins again with the same configuration.
class Machine {
 public:
  Machine(const std::filesystem::path& folder,
          const std::string& name,
          const e2e::LiveDaemonOptions& options);
  e2e::LiveDaemon& first() { return *first_; }
  void signal(int number);
  // Its status.
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
  // Until all is said of instants before now.
  bool goes_on() const;
  // Once somebody has the site, and the broker says so.
  std::string owner() const;
  // What the node has heard since it began, when all of it has been sent.
  void note_captured();

  // The device is quiet, and the workers leave.
  void end_machines();
  // Of every start of the node each number is there or marked, and what the last one heard is
  // there or marked as well. REQUIRES: note_captured().
  void expect_every_datagram();
  // Each owner goes on where the one before it has ended; nothing is said twice.
  void expect_one_story();
  // The witness said what a replay gives, from the first that it heard on, and the other gateway
  // nothing else, each once. What the replay gives.
  std::vector<nlohmann::json> expect_what_was_said();
  std::vector<nlohmann::json> replay(const std::vector<std::string>& more);

  e2e::TemporaryFolder folder_;
  Servers servers_;
  std::shared_ptr<Broker> broker_;
  std::map<std::string, std::unique_ptr<Machine>> machines_;
  std::unique_ptr<e2e::Process> sender_;

 private:
  e2e::LiveDaemonOptions options_of(const std::string& role, const std::string& name) const;
  std::vector<nlohmann::json> heard(const std::string& gateway);

  std::filesystem::path site_;
  std::uint64_t captured_ = 0;
};

}  // namespace rayloc::cluster
