#include "daemon/live/log/background_log.h"

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/patience.h"

namespace rayloc::background_log_test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

const auto kLong = test::patient(60s);

// A terminal that can be stopped, as by Ctrl-S. Outlives the log: its thread may be left in it.
class Terminal {
 public:
  void stop(bool stopped) {
    const std::lock_guard lock(mutex_);
    stopped_ = stopped;
    changed_.notify_all();
  }
  void write(const std::string& line) {
    std::unique_lock lock(mutex_);
    writing_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !stopped_; });
    writing_ = false;
    lines_.push_back(line);
    changed_.notify_all();
  }
  void wait_until_writing() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return writing_; });
  }
  void wait_for_lines(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return lines_.size() >= count; });
  }
  std::vector<std::string> lines() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;
  bool writing_ = false;
  std::vector<std::string> lines_;
};

BackgroundLog::Write to(const std::shared_ptr<Terminal>& terminal) {
  return [terminal](const LogEntry& entry) { terminal->write(entry.message); };
}

void put(BackgroundLog& log, const std::string& message) {
  log.put({spdlog::level::info, std::chrono::system_clock::now(), message});
}

TEST(BackgroundLog, WritesInOrderAndTheRestAtItsEnd) {
  const auto terminal = std::make_shared<Terminal>();
  {
    BackgroundLog log(to(terminal), 8, kLong);
    put(log, "a");
    put(log, "b");
    EXPECT_TRUE(log.flush());
    EXPECT_THAT(terminal->lines(), ElementsAre("a", "b"));
    put(log, "c");
  }
  EXPECT_THAT(terminal->lines(), ElementsAre("a", "b", "c"));
}

TEST(BackgroundLog, DropsTheOldestAndCountsItWhenNothingIsTaken) {
  const auto terminal = std::make_shared<Terminal>();
  terminal->stop(true);
  BackgroundLog log(to(terminal), 3, kLong);
  put(log, "first");
  terminal->wait_until_writing();  // it waits no more
  for (const char* const message : {"a", "b", "c", "d", "e"}) {
    put(log, message);  // returns at once
  }
  EXPECT_EQ(log.dropped(), 2U);
  terminal->stop(false);
  EXPECT_TRUE(log.flush());
  EXPECT_THAT(terminal->lines(), ElementsAre("first", "c", "d", "e"));
}

TEST(BackgroundLog, EndsWithoutAWriterThatDoesNotComeBack) {
  const auto terminal = std::make_shared<Terminal>();
  terminal->stop(true);
  {
    BackgroundLog log(to(terminal), 3, 10ms);
    put(log, "a");
    put(log, "b");
    terminal->wait_until_writing();
    EXPECT_FALSE(log.flush());
  }
  terminal->stop(false);  // too late for us, and harmless
  terminal->wait_for_lines(2);
}

TEST(BackgroundLog, GoesOnAfterAWriterThatThrows) {
  const auto terminal = std::make_shared<Terminal>();
  BackgroundLog log(
      [terminal](const LogEntry& entry) {
        if (entry.message == "bad") {
          throw std::runtime_error("the journal is away");
        }
        terminal->write(entry.message);
      },
      8,
      kLong);
  put(log, "bad");
  put(log, "good");
  EXPECT_TRUE(log.flush());
  EXPECT_THAT(terminal->lines(), ElementsAre("good"));
}

}  // namespace
}  // namespace rayloc::background_log_test
