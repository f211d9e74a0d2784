#include "tests/cluster/nats_servers.h"

#include <sched.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "daemon/live/cluster/operate/server_check.h"
#include "tests/support/patience.h"

namespace rayloc::cluster {
namespace {

constexpr int kClientPort = 4222;  // the default ports of NATS
constexpr int kServerPort = 6222;
constexpr int kMonitorPort = 8222;
constexpr std::chrono::seconds kPatience{5};

// Two networks: clients reach servers in the first, servers each other in the second.
std::string client_host(std::size_t server) { return "10.83.1." + std::to_string(server + 1); }
std::string server_host(std::size_t server) { return "10.83.2." + std::to_string(server + 1); }
std::string client_link(std::size_t server) { return "clients" + std::to_string(server + 1); }
std::string server_link(std::size_t server) { return "servers" + std::to_string(server + 1); }

// Returns the exit status.
int run(std::vector<std::string> words) {
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  pid_t pid = -1;
  int status = -1;
  if (::posix_spawnp(&pid, argv[0], nullptr, nullptr, argv.data(), environ) != 0 ||
      ::waitpid(pid, &status, 0) != pid) {
    return -1;
  }
  return status;
}

void need(const std::vector<std::string>& words) {
  if (run(words) != 0) {
    std::string what;
    for (const std::string& word : words) {
      what += word + " ";
    }
    throw std::runtime_error("failed: " + what);
  }
}

std::vector<std::string> in_network(pid_t network, std::vector<std::string> words) {
  std::vector<std::string> all = {"nsenter", "--target", std::to_string(network), "--net", "--"};
  all.insert(all.end(), words.begin(), words.end());
  return all;
}

// A process that does nothing, in a network of its own.
pid_t begin_network() {
  std::array<int, 2> ready{};
  if (::pipe(ready.data()) != 0) {
    throw std::runtime_error("no pipe");
  }
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const char done = ::unshare(CLONE_NEWNET) == 0 ? '1' : '0';
    (void)!::write(ready[1], &done, 1);
    while (true) {
      ::pause();
    }
  }
  char done = '0';
  (void)!::read(ready[0], &done, 1);
  ::close(ready[0]);
  ::close(ready[1]);
  if (done != '1') {
    throw std::runtime_error("no network for a server");
  }
  return pid;
}

void connect(pid_t network,
             const std::string& link,
             const std::string& bridge,
             const std::string& inside,
             const std::string& host) {
  need({"ip",
        "link",
        "add",
        link,
        "type",
        "veth",
        "peer",
        "name",
        inside,
        "netns",
        std::to_string(network)});
  need({"ip", "link", "set", link, "master", bridge, "up"});
  need(in_network(network, {"ip", "address", "add", host + "/24", "dev", inside}));
  need(in_network(network, {"ip", "link", "set", inside, "up"}));
}

void write_configuration(const std::filesystem::path& file,
                         const std::filesystem::path& store,
                         std::size_t server) {
  std::ofstream out(file);
  out << "server_name: n" << server + 1 << "\nlisten: \"" << client_host(server) << ':'
      << kClientPort << "\"\nhttp: \"" << client_host(server) << ':' << kMonitorPort
      << "\"\njetstream { store_dir: \"" << store.string()
      << "\" }\ncluster {\n  name: hall\n  listen: \"" << server_host(server) << ':' << kServerPort
      << "\"\n  routes: [";
  for (std::size_t other = 0; other < NatsServers::kCount; ++other) {
    if (other != server) {
      out << "\n    \"nats://" << server_host(other) << ':' << kServerPort << '"';
    }
  }
  out << "\n  ]\n}\n";
}

}  // namespace

std::string NatsServers::why_not() {
  if (!NatsServer::is_installed()) {
    return "no nats-server: install it, or name it in RAYLOC_NATS_SERVER";
  }
  if (is_too_old_for_clusters(NatsServer::version())) {
    return fmt::format("three servers need nats-server {} or newer: name one in RAYLOC_NATS_SERVER",
                       fmt::join(kClusterServer, "."));
  }
  if (::geteuid() != 0) {
    return "networks of their own need root";
  }
  if (run({"ip", "-Version"}) != 0) {
    return "networks of their own need iproute2";
  }
  return "";
}

NatsServers::NatsServers(const std::filesystem::path& folder) {
  if (::unshare(CLONE_NEWNET) != 0) {
    throw std::runtime_error("no network of the test");
  }
  need({"ip", "link", "set", "lo", "up"});
  for (const char* bridge : {"clients", "servers"}) {
    need({"ip", "link", "add", bridge, "type", "bridge"});
    need({"ip", "link", "set", bridge, "up"});
  }
  need({"ip", "address", "add", "10.83.1.254/24", "dev", "clients"});
  for (std::size_t i = 0; i < kCount; ++i) {
    networks_[i] = begin_network();
    need(in_network(networks_[i], {"ip", "link", "set", "lo", "up"}));
    connect(networks_[i], client_link(i), "clients", "eth0", client_host(i));
    connect(networks_[i], server_link(i), "servers", "eth1", server_host(i));
    const std::filesystem::path own = folder / ("n" + std::to_string(i + 1));
    servers_[i] = std::make_unique<NatsServer>(
        own, NatsServer::Place{client_host(i), kClientPort, networks_[i]});
    write_configuration(own / "nats.conf", own / "nats", i);
    servers_[i]->set_configuration(own / "nats.conf");
  }
}

NatsServers::~NatsServers() {
  for (std::size_t i = 0; i < kCount; ++i) {
    servers_[i].reset();
    ::kill(networks_[i], SIGKILL);
    ::waitpid(networks_[i], nullptr, 0);
  }
}

bool NatsServers::start() {
  // No server listens for long without the votes of the others.
  for (const auto& server : servers_) {
    server->launch();
  }
  return std::all_of(
      servers_.begin(), servers_.end(), [](const auto& server) { return server->comes(); });
}

void NatsServers::cut(std::size_t server, Cut from) const {
  need({"ip", "link", "set", server_link(server), "down"});
  if (from == Cut::kFromAll) {
    need({"ip", "link", "set", client_link(server), "down"});
  }
}

void NatsServers::join(std::size_t server) const {
  need({"ip", "link", "set", server_link(server), "up"});
  need({"ip", "link", "set", client_link(server), "up"});
}

std::vector<std::string> NatsServers::urls() const {
  std::vector<std::string> urls;
  for (const auto& server : servers_) {
    urls.push_back(server->url());
  }
  return urls;
}

std::string NatsServers::monitor(std::size_t server, const std::string& path) const {
  httplib::Client client(client_host(server), kMonitorPort);
  client.set_connection_timeout(test::patient(kPatience));
  client.set_read_timeout(test::patient(kPatience));
  const auto answer = client.Get(path);
  return answer && answer->status == 200 ? answer->body : "";
}

std::vector<std::string> NatsServers::stored() const {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto reply =
        nlohmann::json::parse(monitor(i, "/jsz?accounts=true&streams=true"), nullptr, false);
    if (reply.is_discarded()) {
      return {};
    }
    std::map<std::string, std::string> streams;
    for (const auto& account : reply.value("account_details", nlohmann::json::array())) {
      for (const auto& stream : account.value("stream_detail", nlohmann::json::array())) {
        nlohmann::json state = stream.at("state");
        state.erase("consumer_count");
        streams[stream.at("name")] = state.dump();
      }
    }
    std::string line;
    for (const auto& [name, state] : streams) {
      line.append(name).append(" ").append(state).append("\n");
    }
    all.push_back(line);
  }
  return all;
}

}  // namespace rayloc::cluster
