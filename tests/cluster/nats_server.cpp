#include "tests/cluster/nats_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>
#include <vector>

#include "capture/transport/file_descriptor.h"
#include "tests/support/eventually.h"

namespace rayloc::cluster {
namespace {

constexpr std::chrono::seconds kPatience{20};

std::string program() {
  const char* const stated = std::getenv("RAYLOC_NATS_SERVER");
  return stated != nullptr ? stated : "/usr/sbin/nats-server";
}

sockaddr_in address_of(const std::string& host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  ::inet_pton(AF_INET, host.c_str(), &address.sin_addr);
  address.sin_port = htons(port);
  return address;
}

bool listens(const std::string& host, std::uint16_t port) {
  const FileDescriptor probe(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const sockaddr_in address = address_of(host, port);
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

std::uint16_t free_tcp_port() {
  const FileDescriptor probe(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address = address_of("127.0.0.1", 0);
  socklen_t size = sizeof address;
  if (::bind(probe.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return 0;
  }
  return ntohs(address.sin_port);
}

bool NatsServer::is_installed() { return ::access(program().c_str(), X_OK) == 0; }

std::string NatsServer::version() {
  std::array<char, 32> version{};
  FILE* const pipe = ::popen((program() + " --version").c_str(), "re");
  if (pipe != nullptr) {
    if (std::fscanf(pipe, "nats-server: v%31s", version.data()) != 1) {
      version = {};
    }
    ::pclose(pipe);
  }
  return version.data();
}

NatsServer::NatsServer(const std::filesystem::path& folder)
    : NatsServer(folder, Place{"127.0.0.1", free_tcp_port(), 0}) {}

NatsServer::NatsServer(const std::filesystem::path& folder, Place place)
    : folder_(folder / "nats"), place_(std::move(place)) {
  std::filesystem::create_directories(folder_);
}

NatsServer::~NatsServer() { kill(); }

void NatsServer::launch() {
  std::vector<std::string> words = {program(),
                                    "--addr",
                                    place_.host,
                                    "--port",
                                    std::to_string(place_.port),
                                    "--log",
                                    (folder_ / "log").string()};
  if (configuration_.empty()) {
    words.insert(words.end(), {"--jetstream", "--store_dir", folder_.string()});
  } else {
    words.insert(words.end(), {"--config", configuration_.string()});
  }
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (place_.network != 0) {
      const std::string network = "/proc/" + std::to_string(place_.network) + "/ns/net";
      const int net = ::open(network.c_str(), O_RDONLY | O_CLOEXEC);
      if (::setns(net, CLONE_NEWNET) != 0) {
        ::_exit(126);
      }
    }
    const int null = ::open("/dev/null", O_RDWR);
    ::dup2(null, STDOUT_FILENO);
    ::dup2(null, STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
}

bool NatsServer::comes() const {
  return eventually(kPatience, [&] { return listens(place_.host, place_.port); });
}

void NatsServer::limit_store(std::uint64_t memory, std::uint64_t files) {
  configuration_ = folder_ / "limits.conf";
  std::ofstream(configuration_) << "jetstream { store_dir: " << folder_
                                << ", max_memory_store: " << memory << ", max_file_store: " << files
                                << " }\n";
}

void NatsServer::kill() { end(SIGKILL); }

void NatsServer::stop() { end(SIGTERM); }

void NatsServer::end(int signal) {
  if (pid_ > 0) {
    ::kill(pid_, signal);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
}

void NatsServer::lose_store() const { std::filesystem::remove_all(folder_ / "jetstream"); }

// Its threads may run on for a moment.
void NatsServer::freeze() const {
  ::kill(pid_, SIGSTOP);
  ::waitpid(pid_, nullptr, WUNTRACED);
}

void NatsServer::thaw() const { ::kill(pid_, SIGCONT); }

}  // namespace rayloc::cluster
