// A stop while an estimate does not return: ptrace(2) holds its thread, as an estimate without end
// would. The recording is closed, the goodbye sent, the stuck stage named.
#include <sys/ptrace.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e::stuck_stop_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::chrono::seconds kPatience{60};

// The thread of `process` that calls itself so; 0 when there is none.
pid_t thread_of(pid_t process, const std::string& name) {
  for (const auto& task :
       std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task")) {
    if (read_text(task.path() / "comm") == name + "\n") {
      return std::stoi(task.path().filename().string());
    }
  }
  return 0;
}

// Holds one thread, the others go on. Used by one thread only: the kernel regards it as the tracer.
class Held {
 public:
  explicit Held(pid_t thread) : thread_(thread) {
    holds_ = ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) == 0 &&
             ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) == 0 &&
             waitpid(thread, nullptr, __WALL) == thread;
  }
  bool holds() const { return holds_; }
  // The process ends only after the tracer of its thread has seen the end of the thread.
  bool ended() const {
    int status = 0;
    return waitpid(thread_, &status, __WALL | WNOHANG) == thread_ &&
           (WIFEXITED(status) || WIFSIGNALED(status));
  }

 private:
  const pid_t thread_;
  bool holds_ = false;
};

TEST(StuckStop, OtherStepsFinishAndTheBlockedOneIsNamed) {
  const TemporaryFolder folder;
  const std::filesystem::path recordings = folder.path() / "rec";
  LiveDaemon daemon(folder.path(),
                    {.site = bundled(""),
                     .access_points = {"ap2"},
                     .more_configuration = "[engine]\nmethod = \"none\"\n[record]\ndirectory = \"" +
                                           recordings.string() + "\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_EQ(send_for_a_second(folder.path(), daemon), 0);
  const pid_t thread = thread_of(daemon.pid(), "estimation");
  ASSERT_NE(thread, 0);
  const Held held(thread);
  if (!held.holds()) {
    GTEST_SKIP() << "no right to hold a thread here";
  }
  daemon.signal(SIGTERM);
  EXPECT_TRUE(eventually(kPatience, [&] { return held.ended(); })) << daemon.errors();
  EXPECT_EQ(daemon.wait(kPatience), 70) << daemon.errors();
  EXPECT_THAT(daemon.log(),
              ContainsRegex("not stopped after [0-9]+ ms: 'estimation' does not come back"));
  EXPECT_THAT(daemon.log(), Not(HasSubstr("is lost")));
  EXPECT_TRUE(eventually(kPatience, [&] { return !daemon.bodies("goodbye").empty(); }));
  const nlohmann::json last = daemon.bodies("heartbeat").back();
  EXPECT_EQ(number(last.at("recorder").at("written")), 2000U);
  for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
    EXPECT_EQ(entry.path().extension(), ".pcap") << entry.path();
  }
}

}  // namespace
}  // namespace rayloc::e2e::stuck_stop_test
