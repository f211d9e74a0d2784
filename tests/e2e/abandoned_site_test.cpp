// A reload of one of several sites whose disk does not answer: its end is not waited for. When it
// ends after all its port is closed, and the next reload begins the site.
#include <sys/socket.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/daemon/live/http/http_client.h"
#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e::abandoned_site_test {
namespace {

using testing::http_body;
using testing::http_get;

constexpr std::chrono::seconds kPatience{60};
constexpr std::size_t kOffice = 0;  // the sources of the sites
constexpr std::size_t kLab = 1;

// Stops a process until go_on().
class Stopped {
 public:
  explicit Stopped(pid_t process) : process_(process) { kill(process_, SIGSTOP); }
  ~Stopped() { go_on(); }
  Stopped(const Stopped&) = delete;
  Stopped& operator=(const Stopped&) = delete;
  void go_on() {
    if (std::exchange(is_stopped_, false)) {
      kill(process_, SIGCONT);
    }
  }

 private:
  const pid_t process_;
  bool is_stopped_ = true;
};

// The office and the lab, which record.
class AbandonedSite : public ::testing::Test {
 protected:
  AbandonedSite() {
    std::filesystem::create_directory(lab_);
    for (const auto& entry : std::filesystem::directory_iterator(bundled(""))) {
      if (entry.path().string().find(".pcap") == std::string::npos) {
        std::filesystem::copy(
            entry.path(), lab_ / entry.path().filename(), std::filesystem::copy_options::recursive);
      }
    }
    daemon_ = std::make_unique<LiveDaemon>(
        folder_.path(),
        LiveDaemonOptions{
            .more_configuration = "[engine]\nmethod = \"none\"\n[record]\ndirectory = \"" +
                                  (folder_.path() / "rec").string() + "\"\n",
            .sites = {{"office", bundled("")}, {"lab", lab_}}});
  }
  void TearDown() override {
    if (HasFailure()) {
      std::cerr << daemon_->errors();
    }
  }

  nlohmann::json status(const std::string& site) const {
    return nlohmann::json::parse(
        http_body(http_get(daemon_->http_port(), "/site/" + site + "/api/v1/status")));
  }
  std::uint64_t received(const std::string& site) const {
    return number(status(site).at("sources").at(0).at("counters").at("received"));
  }
  // Sends so many datagrams to a source.
  void send(std::size_t source, int datagrams) const {
    Process sender(folder_.path(),
                   "send",
                   "rayloc",
                   {"send",
                    bundled_recording("calibration", "ap2"),
                    "--to",
                    daemon_->address(source),
                    "--rate",
                    std::to_string(datagrams),
                    "--duration",
                    "1"});
    EXPECT_EQ(sender.wait(kPatience), 0) << sender.errors();
  }
  bool logs(const std::string& words) const {
    return eventually(kPatience, [&] { return daemon_->log().find(words) != std::string::npos; });
  }
  // The process that appends to the recording of the lab; 0 when there is none.
  pid_t append_process_of_lab() const {
    for (const auto& [file, process] : append_processes(daemon_->pid())) {
      if (file.string().find("/lab/") != std::string::npos) {
        return process;
      }
    }
    return 0;
  }

  const TemporaryFolder folder_;
  const std::filesystem::path lab_ = folder_.path() / "lab";
  std::unique_ptr<LiveDaemon> daemon_;
};

TEST_F(AbandonedSite, ClosesItsPortWhenItHasEndedAndBeginsWithTheNextReload) {
  ASSERT_TRUE(daemon_->ready());
  const std::string office = status("office").at("started");
  const pid_t append = append_process_of_lab();
  ASSERT_NE(append, 0);
  Stopped disk(append);
  send(kLab, 200);
  ASSERT_TRUE(eventually(kPatience, [&] { return received("lab") == 200; }));

  std::ofstream(lab_ / "site.toml", std::ios::app) << "\n# as it is now\n";
  daemon_->signal(SIGHUP);
  ASSERT_TRUE(logs("is left behind"));
  ASSERT_TRUE(logs("reload again")) << "its port is not free yet";
  EXPECT_FALSE(is_free_port(SOCK_DGRAM, daemon_->port(kLab)));
  send(kLab, 50);
  send(kOffice, 100);
  EXPECT_TRUE(eventually(kPatience, [&] { return received("office") == 100; }));

  disk.go_on();
  ASSERT_TRUE(logs("that was left behind has ended"));
  EXPECT_TRUE(is_free_port(SOCK_DGRAM, daemon_->port(kLab)));

  daemon_->signal(SIGHUP);
  ASSERT_TRUE(logs("prepared anew"));
  send(kLab, 70);
  EXPECT_TRUE(eventually(kPatience, [&] { return received("lab") == 70; }));
  const nlohmann::json reloads = status("lab").at("reloads");
  EXPECT_EQ(number(reloads.at("exchanges")), 1U);
  EXPECT_EQ(number(reloads.at("datagrams_lost")), 50U) << "those that waited in its port";
  EXPECT_EQ(received("office"), 100U);
  EXPECT_EQ(status("office").at("started"), office);
  EXPECT_EQ(daemon_->stop(), 0);
}

}  // namespace
}  // namespace rayloc::e2e::abandoned_site_test
