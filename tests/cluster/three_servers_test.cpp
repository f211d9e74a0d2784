// Three servers keep three copies of each message: one of them is killed, hangs, or is cut off from
// the others (or all) while a device is located. No datagram is lost without a gap mark, no result
// published twice, and the servers store the same afterwards. RAYLOC_SERVER_FAULTS: number of
// faults (tests/soak), then also two servers or a server and a machine at once; by default one of
// each kind. Skipped, by name, if the server is older than 2.14.6.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/live/cluster/cluster_names.h"
#include "tests/cluster/nats_servers.h"
#include "tests/cluster/one_site.h"

namespace rayloc::cluster::three_servers_test {
namespace {

// Longer than the servers need to elect another leader, which is 4 to 9 s.
constexpr std::chrono::seconds kLasts{12};
constexpr std::array kKinds = {
    "killed", "hangs", "begun again", "cut from servers", "cut from all"};
constexpr std::array kMachines = {"worker", "node", "gateway"};

std::size_t faults() {
  const char* const stated = std::getenv("RAYLOC_SERVER_FAULTS");
  return stated == nullptr ? kKinds.size() : std::stoul(stated);
}

struct Fault {
  std::string kind;
  bool of_two = false;       // servers: the third one is alone
  std::string machine = {};  // killed at the same time
};

Fault nth(std::size_t i) {
  constexpr std::size_t kOthers = 3;
  Fault fault{kKinds[i % kKinds.size()]};
  const std::size_t round = i / kKinds.size();
  if (faults() > kKinds.size()) {
    fault.of_two = round % kOthers == 1;
    fault.machine = round % kOthers == 2 ? kMachines[i % kMachines.size()] : "";
  }
  return fault;
}

std::string words(const Fault& fault) {
  return (fault.of_two ? "two servers " : "a server ") + fault.kind +
         (fault.machine.empty() ? "" : ", " + fault.machine + " killed");
}

class ThreeServers : public OneSite {
 protected:
  void SetUp() override {
    if (const std::string why = NatsServers::why_not(); !why.empty()) {
      GTEST_SKIP() << why;
    }
    servers_of_hall_ = std::make_unique<NatsServers>(folder_.path());
    ASSERT_TRUE(servers_of_hall_->start());
    begin_machines({servers_of_hall_->urls(), static_cast<int>(NatsServers::kCount)});
  }

  // The leader of the stream of results; nothing if there is none.
  std::optional<std::size_t> leader() {
    const auto reply = broker_->ask("$JS.API.STREAM.INFO." + std::string(kOutputStream), "");
    const auto info = nlohmann::json::parse(reply.value_or(""), nullptr, false);
    if (info.is_discarded() || !info.contains("cluster")) {
      return std::nullopt;
    }
    const std::string name = info["cluster"].value("leader", "");
    return name.empty() ? std::nullopt : std::optional<std::size_t>(name.at(1) - '1');
  }

  void begin(std::size_t server, const std::string& kind) {
    NatsServer& one = servers_of_hall_->at(server);
    if (kind == "killed") {
      one.kill();
    } else if (kind == "begun again") {
      one.stop();
      EXPECT_TRUE(one.start());
    } else if (kind == "hangs") {
      one.freeze();
    } else {
      servers_of_hall_->cut(
          server,
          kind == "cut from all" ? NatsServers::Cut::kFromAll : NatsServers::Cut::kFromServers);
    }
  }
  void end(std::size_t server, const std::string& kind) {
    NatsServer& one = servers_of_hall_->at(server);
    if (kind == "killed") {
      EXPECT_TRUE(one.start());
    } else if (kind == "hangs") {
      one.thaw();
    } else if (kind != "begun again") {
      servers_of_hall_->join(server);
    }
  }
  void fail(const Fault& fault) {
    std::optional<std::size_t> first;
    ASSERT_TRUE(eventually(kPatience, [&] { return (first = leader()).has_value(); }));
    std::vector<std::size_t> servers = {*first};
    if (fault.of_two) {
      servers.push_back((*first + 1) % NatsServers::kCount);
    }
    const std::string machine = fault.machine == "worker" ? owner() : fault.machine;
    for (const std::size_t server : servers) {
      begin(server, fault.kind);
    }
    if (!machine.empty()) {
      machines_.at(machine)->end(SIGKILL);
      machines_.at(machine)->begin();
    }
    if (fault.kind != "begun again") {
      std::this_thread::sleep_for(kLasts);
    }
    for (const std::size_t server : servers) {
      end(server, fault.kind);
    }
  }
  // All three servers store the same.
  void expect_same_stores() {
    std::vector<std::string> stored;
    EXPECT_TRUE(eventually(kPatience, [&] {
      stored = servers_of_hall_->stored();
      return stored.size() == NatsServers::kCount && !stored.front().empty() &&
             std::all_of(stored.begin(), stored.end(), [&](const std::string& one) {
               return one == stored.front();
             });
    }));
    for (const std::string& one : stored) {
      std::cout << one << '\n';
    }
  }

  std::unique_ptr<NatsServers> servers_of_hall_;
};

TEST_F(ThreeServers, LoseNothingThatTheyHaveAcknowledged) {
  std::map<std::string, std::vector<double>> seconds;
  for (std::size_t i = 0; i < faults(); ++i) {
    const Fault now = nth(i);
    const auto begin = std::chrono::steady_clock::now();
    fail(now);
    ASSERT_TRUE(goes_on()) << words(now) << machines_.at("w1")->errors()
                           << machines_.at("w2")->errors();
    seconds[words(now)].push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  for (auto& [fault, all] : seconds) {
    std::sort(all.begin(), all.end());
    std::cout << fault << " (" << all.size() << "): said of everything again after " << all.front()
              << " to " << all.back() << " s\n";
  }
  end_machines();
  // A server that was cut off regards itself as the leader until it reaches the others again.
  expect_same_stores();
  expect_one_story();
  expect_every_datagram();
  EXPECT_FALSE(expect_published().empty());
}

}  // namespace
}  // namespace rayloc::cluster::three_servers_test
