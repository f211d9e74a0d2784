// Tests a child process: its output, its status, and that it ends with its parent. The calibration
// itself is a process of `rayloc` (tests/e2e/map_test.py, first-hour).
#include "daemon/live/studio/calibration_job.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace rayloc::calibration_job_test {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<ChildProcess> shell(const std::string& script) {
  auto process = ChildProcess::start("/bin/sh", {"-c", script});
  if (!process) {
    ADD_FAILURE() << process.error().message;
    return nullptr;
  }
  return *std::move(process);
}

// Once it has ended.
int status_of(ChildProcess& process) {
  while (!process.status()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return *process.status();
}

void wait_for_word(ChildProcess& process) {
  while (process.errors().empty() && !process.status()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST(ChildProcess, ReportsItsErrorOutputAndExitStatus) {
  const auto process = shell("echo one >&2; echo nothing; echo two >&2; exit 3");
  ASSERT_NE(process, nullptr);
  EXPECT_EQ(status_of(*process), 3);
  EXPECT_EQ(process->errors(), "one\ntwo\n");
  EXPECT_FALSE(process->was_stopped());
}

TEST(ChildProcess, HasNothingOfOursOpenAndNoSignalsBlocked) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  const int kept = dup(STDOUT_FILENO);  // without FD_CLOEXEC
  const auto process = shell("ls /proc/self/fd | wc -l >&2; grep SigBlk /proc/self/status >&2");
  ASSERT_NE(process, nullptr);
  EXPECT_EQ(status_of(*process), 0);
  EXPECT_EQ(process->errors(), "4\nSigBlk:\t0000000000000000\n");  // three, and the folder itself
  close(kept);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST(ChildProcess, IsAskedToEndAndThenKilled) {
  const auto obeys = shell("echo here >&2; exec sleep 1000");
  ASSERT_NE(obeys, nullptr);
  wait_for_word(*obeys);
  obeys->stop();
  EXPECT_EQ(status_of(*obeys), 128 + SIGTERM);
  const auto stubborn = shell("trap '' TERM; echo here >&2; while true; do sleep 0.05; done");
  ASSERT_NE(stubborn, nullptr);
  wait_for_word(*stubborn);
  stubborn->stop();
  EXPECT_EQ(stubborn->status(), std::nullopt);
  stubborn->stop();
  EXPECT_EQ(status_of(*stubborn), 128 + SIGKILL);
}

TEST(ChildProcess, EndsWithItsOwner) {
  auto process = shell("echo $$ >&2; exec sleep 1000");
  ASSERT_NE(process, nullptr);
  wait_for_word(*process);
  const pid_t its = std::stoi(process->errors());
  ASSERT_EQ(kill(its, 0), 0);
  process.reset();
  EXPECT_NE(kill(its, 0), 0);
}

TEST(ChildProcess, ReportsAMissingProgram) {
  auto process = ChildProcess::start("/nowhere/rayloc", {});
  ASSERT_TRUE(process) << process.error().message;
  EXPECT_EQ(status_of(**process), 127);
}

TEST(ChildProcess, HasTheStatedDescriptorsAndLimits) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> input(std::tmpfile(), &std::fclose);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> output(std::tmpfile(), &std::fclose);
  ASSERT_TRUE(input && output);
  ASSERT_EQ(pwrite(fileno(input.get()), "content", 7, 0), 7);
  auto process = ChildProcess::start("/bin/sh",
                                     {"-c", "cat; ulimit -v >&2; ulimit -t >&2; ulimit -f >&2"},
                                     {.input = fileno(input.get()),
                                      .output = fileno(output.get()),
                                      .memory_bytes = std::uint64_t{1} << 30U,
                                      .processor_seconds = 7,
                                      .file_bytes = 1024});
  ASSERT_TRUE(process) << process.error().message;
  EXPECT_EQ(status_of(**process), 0);
  EXPECT_EQ((*process)->errors(), "1048576\n7\n2\n");  // KiB, s, blocks of 512 bytes
  char read[8] = {};
  EXPECT_EQ(pread(fileno(output.get()), read, sizeof read, 0), 7);
  EXPECT_STREQ(read, "content");
}

class CalibrationJobTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rayloc-job." + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string refusal(const std::string& what) {
    CalibrationJob job(folder_, [](Timestamp) -> Expected<std::vector<std::string>> {
      return bad_input("nothing is recorded");
    });
    const auto started = job.start(what);
    EXPECT_FALSE(started);
    EXPECT_EQ(job.state().dump(), R"({"offered":true,"running":false})");
    EXPECT_FALSE(job.report());
    return started ? "" : started.error().message;
  }

  fs::path folder_;
};

TEST_F(CalibrationJobTest, ReportsMissingInputs) {
  EXPECT_EQ(refusal("walls"), "write what=all or what=chains");
  EXPECT_EQ(refusal("all").rfind("walk a survey first: ", 0), 0U) << refusal("all");
  std::ofstream(folder_ / "survey.csv") << "t_start,t_end,x,y,z\n1760000000,1760000002,1,2,1.2\n";
  EXPECT_EQ(refusal("all"), "nothing is recorded");
  std::ofstream(folder_ / "calibration.toml") << "\n";
  EXPECT_NE(refusal("all").find("is calibrated already"), std::string::npos) << refusal("all");
}

}  // namespace
}  // namespace rayloc::calibration_job_test
