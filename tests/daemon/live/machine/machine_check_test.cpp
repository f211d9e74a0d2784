// Tests findings of `rayloc doctor` on ports and secrets; the others depend on the machine.
#include "daemon/live/machine/machine_check.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::machine_check_test {
namespace {

using ::testing::HasSubstr;
using Kind = Finding::Kind;

// The one finding that speaks of `what`.
Finding finding_of(const DaemonConfig& config, const std::string& what) {
  const std::vector<Finding> findings = check_machine(config, false);
  const auto found = std::find_if(findings.begin(), findings.end(), [&](const Finding& finding) {
    return finding.what.find(what) != std::string::npos;
  });
  return found != findings.end() ? *found : Finding{Kind::kProblem, "nothing", ""};
}

// A listening socket of the loopback interface.
class Listener {
 public:
  Listener() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (bind(fd_, reinterpret_cast<const sockaddr*>(&address), size) == 0 && listen(fd_, 1) == 0 &&
        getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size) == 0) {
      port_ = std::to_string(ntohs(address.sin_port));
    }
  }
  ~Listener() { close(fd_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  const std::string& port() const { return port_; }

 private:
  int fd_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  std::string port_;
};

TEST(MachineCheck, AnEndpointMayNameItsAddressOrTheLoopbackByName) {
  const Listener other;
  ASSERT_FALSE(other.port().empty());
  for (const char* const host : {"127.0.0.1", "localhost", "*"}) {
    DaemonConfig config;
    config.publish.endpoint = "tcp://" + std::string(host) + ":" + other.port();
    const Finding finding = finding_of(config, "publishing");
    EXPECT_EQ(finding.kind, Kind::kProblem) << host;
    EXPECT_THAT(finding.what, HasSubstr("Address already in use")) << host;
  }
  DaemonConfig any;
  any.publish.endpoint = "tcp://127.0.0.1:*";
  EXPECT_EQ(finding_of(any, "publishing").what, "nothing") << "a free one is taken";
}

TEST(MachineCheck, SecretsMustBeThere) {
  const std::filesystem::path key =
      std::filesystem::temp_directory_path() / ("machine_check." + std::to_string(getpid()));
  DaemonConfig config;
  config.privacy.target_id = TargetId::kHmac;
  config.privacy.key_file = key;
  config.http.enabled = true;
  config.http.host = "127.0.0.1";
  config.http.token_file = key;
  for (const char* const name : {"[privacy] key_file", "[http] token_file"}) {
    const Finding missing = finding_of(config, name);
    EXPECT_EQ(missing.kind, Kind::kProblem) << name;
    EXPECT_THAT(missing.what, HasSubstr("No such file or directory")) << name;
  }
  std::ofstream(key) << "secret";
  std::filesystem::permissions(key, std::filesystem::perms(0600));
  for (const char* const name : {"[privacy] key_file", "[http] token_file"}) {
    EXPECT_EQ(finding_of(config, name).kind, Kind::kOk) << name;
  }
  std::filesystem::permissions(key, std::filesystem::perms(0644));
  for (const char* const name : {"[privacy] key_file", "[http] token_file"}) {
    const Finding open = finding_of(config, name);
    EXPECT_EQ(open.kind, Kind::kProblem) << name;
    EXPECT_THAT(open.what, HasSubstr("everyone on this machine may use this secret")) << name;
  }
  std::filesystem::remove(key);
}

TEST(MachineCheck, AnUnreadableKeyCausesAWarning) {
  DaemonConfig config;
  config.curve.enabled = true;
  const Finding unseen = finding_of(config, "[curve]");
  EXPECT_EQ(unseen.kind, Kind::kWarning);
  EXPECT_THAT(unseen.what, HasSubstr("no credential curve.secret"));
  EXPECT_THAT(unseen.advice, HasSubstr("curve.conf"));
  const std::vector<Finding> running = check_machine(config, true);
  EXPECT_TRUE(std::any_of(running.begin(), running.end(), [](const Finding& finding) {
    return finding.kind == Kind::kOk &&
           finding.what.find("it has its secret key") != std::string::npos;
  }));
}

}  // namespace
}  // namespace rayloc::machine_check_test
