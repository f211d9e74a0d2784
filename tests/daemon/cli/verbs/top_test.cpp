// `rayloc top` as a process of its own: on a real pseudo-terminal, and without one.
#include <fcntl.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <thread>

#include <gtest/gtest.h>

#include "daemon/live/publish/publisher.h"
#include "daemon/live/publish/snapshot_server.h"
#include "daemon/messages/last_messages.h"
#include "daemon/messages/proto_time.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/support/eventually.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::top_test {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 60s;
const std::string kEnter = "\x1b[?1049h\x1b[?25l";
const std::string kLeave = "\x1b[?25h\x1b[?1049l";

// A daemon as far as subscribers see one.
class TestPublisher {
 public:
  TestPublisher() : publisher_(bind(last_)) {
    v1::ZoneEvent event;
    event.set_zone("desk");
    event.set_kind(v1::ZONE_EVENT_KIND_ENTERED);
    event.set_occupancy(1);
    event.add_inside()->set_mac("02:52:4c:00:00:01");
    publisher_.publish(event, Timestamp(1'718'000'000s));  // long before anybody asks
  }
  const std::string& endpoint() const { return publisher_.endpoint(); }
  const std::string& snapshot() const { return snapshots_->endpoint(); }

  void publish_once() {
    const Timestamp now(1'718'000'000s + ++published_ * 1s);
    v1::Location location;
    location.set_kind(v1::LOCATION_KIND_FILTERED);
    location.set_mode(v1::FIX_MODE_2D);
    location.set_track_state(v1::TRACK_STATE_CONFIRMED);
    location.mutable_target()->set_mac("02:52:4c:00:00:01");
    location.mutable_target()->set_name("ph\x1b[31mone");
    location.mutable_position()->set_x(-1.25);
    location.set_accuracy_m(0.4);
    location.set_accuracy_confidence(0.95);
    publisher_.publish(location, now);
    v1::Heartbeat heartbeat;
    heartbeat.set_software_version("9.8.7");
    *heartbeat.mutable_time() = to_proto(now);
    *heartbeat.mutable_started() = to_proto(Timestamp(1'717'999'880s));
    v1::SourceReport* source = heartbeat.add_sources();
    source->set_access_point("ap1");
    source->set_status(v1::SOURCE_STATUS_RECEIVING);
    source->mutable_counters()->set_received(250 * static_cast<std::uint64_t>(published_));
    source->mutable_counters()->set_frames_dropped(3);
    heartbeat.mutable_estimation()->set_fixes(77);
    publisher_.publish(heartbeat, now);
  }

 private:
  static Publisher bind(const std::shared_ptr<LastMessages>& last) {
    PublisherOptions options;
    options.last = last;
    options.endpoint = "tcp://127.0.0.1:*";
    options.site = "office";
    options.epoch = 7;
    return std::move(Publisher::bind(options).value());
  }
  std::shared_ptr<LastMessages> last_ = std::make_shared<LastMessages>(100);
  Publisher publisher_;
  std::unique_ptr<SnapshotServer> snapshots_ =
      SnapshotServer::open({.endpoint = "tcp://127.0.0.1:*", .epoch = 7, .last = last_}).value();
  int published_ = 0;
};

// `rayloc top` on a terminal of its own.
class TopOnTerminal {
 public:
  explicit TopOnTerminal(const TestPublisher& publisher) {
    const winsize size{24, 140, 0, 0};
    pid_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (pid_ == 0) {
      ::setenv("TERM", "xterm", 1);
      ::execl(test::program_path("rayloc").c_str(),
              "rayloc",
              "top",
              "--interval",
              "0.1",
              "--endpoint",
              publisher.endpoint().c_str(),
              "--snapshot",
              publisher.snapshot().c_str(),
              nullptr);
      ::_exit(127);
    }
    ::fcntl(terminal_, F_SETFL, O_NONBLOCK);
  }
  ~TopOnTerminal() {
    if (!status_) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(terminal_);
  }
  TopOnTerminal(const TopOnTerminal&) = delete;
  TopOnTerminal& operator=(const TopOnTerminal&) = delete;

  const std::string& shown() {
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = ::read(terminal_, buffer.data(), buffer.size())) > 0;) {
      shown_.append(buffer.data(), static_cast<std::size_t>(n));
    }
    return shown_;
  }
  // The lines of the last whole picture that began after `from`.
  std::vector<std::string> picture(std::size_t from = 0) {
    const std::string& all = shown();
    const std::size_t end = all.rfind("\x1b[J");
    const std::size_t begin = end == std::string::npos ? end : all.rfind("\x1b[H", end);
    std::vector<std::string> lines;
    if (begin == std::string::npos || begin < from) {
      return lines;
    }
    std::string rest = all.substr(begin + 3, end - begin - 3);
    for (std::size_t at = 0; (at = rest.find("\x1b[K")) != std::string::npos;) {
      lines.push_back(rest.substr(0, at));
      rest.erase(0, at + 3);
      // The terminal turns a line feed into a return and a line feed, after any character.
      rest.erase(0, std::min(rest.find_first_not_of("\r\n"), rest.size()));
    }
    return lines;
  }
  void press(char key) { EXPECT_EQ(::write(terminal_, &key, 1), 1); }
  void signal(int number) const { ::kill(pid_, number); }
  void resize(std::uint16_t rows, std::uint16_t columns) const {
    const winsize size{rows, columns, 0, 0};
    EXPECT_EQ(::ioctl(terminal_, TIOCSWINSZ, &size), 0);
  }
  bool is_cooked() const {
    termios settings{};
    EXPECT_EQ(::tcgetattr(terminal_, &settings), 0);
    return (settings.c_lflag & ICANON) != 0 && (settings.c_lflag & ECHO) != 0;
  }
  std::optional<int> status() {
    int raw = 0;
    shown();  // a process whose terminal is full does not end
    if (!status_ && ::waitpid(pid_, &raw, WNOHANG) == pid_) {
      status_ = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
    }
    return status_;
  }

 private:
  int terminal_ = -1;
  pid_t pid_ = -1;
  std::string shown_;
  std::optional<int> status_;
};

bool contains(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(text) != std::string::npos;
  });
}

class TopTest : public ::testing::Test {
 protected:
  // Until `condition` holds, with something new to show all the time.
  bool speaking_until(const std::function<bool()>& condition) {
    return eventually(kPatience, [&] {
      publisher_.publish_once();
      return condition();
    });
  }
  TestPublisher publisher_;
};

TEST_F(TopTest, ShowsPublishedMessagesAndRestoresTheTerminal) {
  TopOnTerminal top(publisher_);
  ASSERT_TRUE(speaking_until([&] { return contains(top.picture(), "02:52:4c:00:00:01"); }))
      << top.shown();
  ASSERT_TRUE(speaking_until([&] { return contains(top.picture(), "250"); }));  // a rate
  const std::vector<std::string> picture = top.picture();
  for (const char* text : {"raylocd 9.8.7",
                           "ph?[31mone",
                           "filtered",
                           "2d",
                           "-1.25",
                           "0.40 m 95 %",
                           "confirmed",
                           "desk",
                           "ap1",
                           "receiving",
                           "77 fixes"}) {
    EXPECT_TRUE(contains(picture, text)) << text;
  }
  EXPECT_TRUE(top.shown().starts_with(kEnter));
  EXPECT_FALSE(top.is_cooked());
  top.press('q');
  ASSERT_TRUE(eventually(kPatience, [&] { return top.status().has_value(); }));
  EXPECT_EQ(top.status(), 0);
  EXPECT_TRUE(top.shown().ends_with(kLeave));
  EXPECT_TRUE(top.is_cooked());
}

TEST_F(TopTest, FitsTheTerminalWhenItsSizeChanges) {
  TopOnTerminal top(publisher_);
  ASSERT_TRUE(speaking_until([&] { return top.picture().size() > 8; }));
  top.resize(5, 30);
  const std::size_t before = top.shown().size();
  ASSERT_TRUE(speaking_until([&] { return top.picture(before).size() == 5; }));
  for (const std::string& line : top.picture(before)) {
    EXPECT_LE(line.size(), 30U) << line;
  }
}

TEST_F(TopTest, GivesTheTerminalBackOnSignals) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    TopOnTerminal top(publisher_);
    ASSERT_TRUE(speaking_until([&] { return !top.picture().empty(); }));
    top.signal(signal);
    ASSERT_TRUE(eventually(kPatience, [&] { return top.status().has_value(); })) << signal;
    EXPECT_EQ(top.status(), 0) << signal;
    EXPECT_TRUE(top.shown().ends_with(kLeave)) << signal;
    EXPECT_TRUE(top.is_cooked()) << signal;
  }
}

TEST_F(TopTest, GivesTheTerminalToTheShellWhileItIsStopped) {
  TopOnTerminal top(publisher_);
  ASSERT_TRUE(speaking_until([&] { return !top.picture().empty(); }));
  top.signal(SIGTSTP);
  // The kernel does not stop an orphaned process group: the program returns at once.
  ASSERT_TRUE(
      speaking_until([&] { return top.shown().find(kLeave + kEnter) != std::string::npos; }));
  const std::size_t back = top.shown().find(kLeave + kEnter);
  EXPECT_TRUE(speaking_until([&] { return !top.picture(back).empty(); }));
}

TEST_F(TopTest, PrintsOneTableWhereThereIsNoTerminal) {
  for (const bool once : {true, false}) {
    std::vector<std::string> arguments = {"top", "--endpoint", publisher_.endpoint()};
    if (once) {
      arguments.emplace_back("--once");
    }
    const RaylocProcess process(arguments);
    std::atomic<bool> done = false;
    Finished finished;
    std::thread waiting([&] {
      finished = process.wait();
      done = true;
    });
    EXPECT_TRUE(speaking_until([&] { return done.load(); }));
    waiting.join();
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_EQ(finished.err, "");
    EXPECT_EQ(finished.out.find('\x1b'), std::string::npos);
    EXPECT_NE(finished.out.find("02:52:4c:00:00:01  ph?[31mone  filtered  2d"), std::string::npos)
        << finished.out;
    EXPECT_NE(finished.out.find("ap1           receiving"), std::string::npos) << finished.out;
  }
}

TEST_F(TopTest, ASnapshotGivesZoneMembersFromTheBeginning) {
  for (const bool asks : {true, false}) {
    std::vector<std::string> arguments = {"top", "--once", "--endpoint", publisher_.endpoint()};
    if (asks) {
      arguments.insert(arguments.end(), {"--snapshot", publisher_.snapshot()});
    }
    const RaylocProcess process(arguments);
    std::atomic<bool> done = false;
    Finished finished;
    std::thread waiting([&] {
      finished = process.wait();
      done = true;
    });
    EXPECT_TRUE(speaking_until([&] { return done.load(); }));
    waiting.join();
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_EQ(finished.out.find("desk") != std::string::npos, asks) << finished.out;
    EXPECT_EQ(finished.out.find("confirmed  desk") != std::string::npos, asks) << finished.out;
  }
}

TEST(Top, ReportsThatNoDaemonIsRunning) {
  const Finished finished =
      RaylocProcess({"top", "--once", "--endpoint", "ipc:///nowhere/at/all", "--timeout", "0.3"})
          .wait();
  EXPECT_EQ(finished.status, 69);
  EXPECT_EQ(finished.err,
            "rayloc: no heartbeat from ipc:///nowhere/at/all; is raylocd running there?\n");
}

}  // namespace
}  // namespace rayloc::top_test
