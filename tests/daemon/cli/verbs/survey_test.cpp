// `rayloc survey` as a process: answers from a pipe, frames over a real port.
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "capture/source/udp_source.h"
#include "daemon/site/survey/points_csv.h"
#include "tests/support/eventually.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"
#include "tests/support/wire_writer.h"

namespace rayloc::survey_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSite = test::data_path("/sites/meeting_room");
constexpr std::chrono::seconds kPatience{60};

// One that was free a moment ago.
std::uint16_t free_port() { return (*UdpSource::open({.address = "127.0.0.1:0"}))->port(); }

constexpr std::uint64_t kDevice = 0x02524c000001;  // of the site
constexpr std::uint64_t kFixed = 0x02524c000002;
constexpr std::uint64_t kStranger = 0x02524c0000aa;

// An access point that receives a frame of a transmitter every two milliseconds.
class SimulatedDevice {
 public:
  explicit SimulatedDevice(std::uint16_t port, std::uint64_t transmitter = kDevice)
      : transmitter_(transmitter),
        socket_(::socket(AF_INET, SOCK_DGRAM, 0)),
        thread_([this, port] { send(port); }) {}
  ~SimulatedDevice() {
    stop_ = true;
    thread_.join();
    ::close(socket_);
  }

 private:
  void send(std::uint16_t port) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    test::WireFrame frame;
    frame.rx_chains = {0, 2, 3};
    frame.transmitter = transmitter_;
    while (!stop_) {
      ++frame.sequence;
      for (const auto& datagram : test::write_axcsi(frame, Timestamp{})) {
        ::sendto(socket_,
                 datagram.payload.data(),
                 datagram.payload.size(),
                 0,
                 reinterpret_cast<const sockaddr*>(&to),
                 sizeof(to));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  std::atomic<bool> stop_{false};
  std::uint64_t transmitter_;
  int socket_;
  std::thread thread_;
};

// "2026-01-02T03:04:05.678901Z"
Timestamp time_of(const std::string& text) {
  const auto number = [&](std::size_t first, std::size_t count) {
    return std::stoi(text.substr(first, count));
  };
  const auto day = std::chrono::year(number(0, 4)) / number(5, 2) / number(8, 2);
  return Timestamp(std::chrono::sys_days(day)) + std::chrono::hours(number(11, 2)) +
         std::chrono::minutes(number(14, 2)) + std::chrono::seconds(number(17, 2)) +
         std::chrono::microseconds(number(20, 6));
}

class SurveyVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) /
        (std::string("survey_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ / name; }
  std::string read(const std::string& name) const {
    std::ifstream in(path(name));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // Returns the exit status; standard error goes to "err", standard output to "out".
  int survey(const std::string& answers, const std::string& arguments) const {
    std::ofstream(path("answers")) << answers;
    const std::string command = test::program_path("rayloc") + " survey " + kSite + " --out " +
                                path("points.csv") + " " + arguments + " < " + path("answers") +
                                " > " + path("out") + " 2> " + path("err");
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  fs::path folder_;
};

// The time limit at a point whose frames must arrive within that time.
std::string timeout(std::chrono::milliseconds time) {
  return " --timeout " + std::to_string(to_seconds(test::patient(time)));
}

TEST_F(SurveyVerb, WritesARowWhoseTimeHoldsTheFramesThatWereCounted) {
  const std::uint16_t port = free_port();
  const SimulatedDevice device(port);
  const int status = survey("0.5,0.2,1.2\n-0.5,0.25\nq\n",
                            "--frames 7 --listen ap1=127.0.0.1:" + std::to_string(port) +
                                " --record ap1=" + path("ap1.pcap"));
  ASSERT_EQ(status, 0) << read("err");
  const auto points = load_points_csv(path("points.csv"));
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 2U);
  EXPECT_EQ((*points)[0].position, (Vec3d{0.5, 0.2, 1.2}));
  EXPECT_EQ((*points)[1].position, (Vec3d{-0.5, 0.25, 1.2}));
  EXPECT_LE((*points)[0].t_end, (*points)[1].t_start);

  // The recording, read by another verb, has those frames in those times.
  ASSERT_EQ(std::system((test::program_path("rayloc") + " frames ap1=" + path("ap1.pcap") +
                         " --json > " + path("frames"))
                            .c_str()),
            0);
  std::ifstream frames(path("frames"));
  std::array<int, 2> within{};
  for (std::string line; std::getline(frames, line);) {
    const auto frame = nlohmann::json::parse(line);
    if (!frame.contains("time") || frame["cores"].size() != 3) {
      continue;
    }
    const Timestamp time = time_of(frame["time"]);
    for (std::size_t i = 0; i < 2; ++i) {
      const bool in_row = (*points)[i].t_start <= time && time <= (*points)[i].t_end;
      within.at(i) += in_row ? 1 : 0;
    }
  }
  EXPECT_GE(within[0], 7);
  EXPECT_GE(within[1], 7);
}

TEST_F(SurveyVerb, RefusesAPointOutsideOfTheRoomAndAsksAgain) {
  const std::uint16_t port = free_port();
  const SimulatedDevice device(port);
  ASSERT_EQ(survey("0.5,9,1.2\n0.5,0.2,1.2\nq\n",
                   "--frames 3 --listen ap1=127.0.0.1:" + std::to_string(port)),
            0);
  EXPECT_THAT(read("err"), HasSubstr("outside of the room: x -1.76 to 1.76"));
  const auto points = load_points_csv(path("points.csv"));
  ASSERT_TRUE(points);
  EXPECT_EQ(points->size(), 1U);
}

TEST_F(SurveyVerb, EnterTakesThePlannedPointThatHasNoRowYet) {
  std::ofstream(path("plan.csv")) << "x,y,z,name\n0.1,0.2,1.2,first\n0.4,0.2,1.2,second\n";
  const std::uint16_t port = free_port();
  const SimulatedDevice device(port);
  const std::string arguments =
      "--frames 3 --plan " + path("plan.csv") + " --listen ap1=127.0.0.1:" + std::to_string(port);
  ASSERT_EQ(survey("\nq\n", arguments), 0);
  EXPECT_THAT(read("err"), HasSubstr("Enter for first at 0.100,0.200,1.200"));
  // Interrupted and continued: the file contains the finished points.
  ASSERT_EQ(survey("\nq\n", arguments), 0);
  EXPECT_THAT(read("err"), HasSubstr("Enter for second"));
  EXPECT_THAT(read("err"), Not(HasSubstr("Enter for first")));
  const auto points = load_points_csv(path("points.csv"));
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 2U);
  EXPECT_EQ((*points)[0].position, (Vec3d{0.1, 0.2, 1.2}));
  EXPECT_EQ((*points)[1].position, (Vec3d{0.4, 0.2, 1.2}));
}

TEST_F(SurveyVerb, WarnsOfAnAccessPointWithoutFrames) {
  const std::uint16_t received_port = free_port();
  const std::uint16_t silent = free_port();
  const SimulatedDevice device(received_port);
  ASSERT_EQ(survey("0.5,0.2,1.2\nq\n",
                   "--frames 3" + timeout(std::chrono::milliseconds(1000)) +
                       " --listen ap1=127.0.0.1:" + std::to_string(received_port) +
                       " ap2=127.0.0.1:" + std::to_string(silent)),
            0);
  EXPECT_THAT(read("err"), HasSubstr("warning: ap2 received no whole frame"));
  EXPECT_THAT(read("err"), Not(HasSubstr("warning: ap1")));
  EXPECT_EQ(load_points_csv(path("points.csv"))->size(), 1U);
}

TEST_F(SurveyVerb, WritesNoRowWithoutFrames) {
  ASSERT_EQ(survey("0.5,0.2,1.2\nq\n",
                   "--timeout 0.2 --listen ap1=127.0.0.1:" + std::to_string(free_port())),
            0);
  EXPECT_THAT(read("err"), HasSubstr("no frame was received: the point is not written"));
  EXPECT_EQ(read("points.csv"), "t_start,t_end,x,y,z\n");
  EXPECT_THAT(read("out"), HasSubstr("\"points\":0"));
}

TEST_F(SurveyVerb, FramesOfAFixedTransmitterDoNotCount) {
  const std::uint16_t port = free_port();
  const SimulatedDevice fixed(port, kFixed);
  ASSERT_EQ(survey("0.5,0.2,1.2\nq\n",
                   timeout(std::chrono::milliseconds(500)) + " --listen ap1=127.0.0.1:" +
                       std::to_string(port) + " --record ap1=" + path("ap1.pcap")),
            0);
  EXPECT_THAT(read("err"), HasSubstr("ap1 0/20"));
  EXPECT_GT(fs::file_size(path("ap1.pcap")), 1000U) << "they were heard";
}

// The site lists the device that is carried about.
TEST_F(SurveyVerb, FramesOfAnUnlistedPhoneDoNotCount) {
  const std::uint16_t port = free_port();
  const SimulatedDevice stranger(port, kStranger);
  ASSERT_EQ(survey("0.5,0.2,1.2\nq\n",
                   timeout(std::chrono::milliseconds(500)) + " --listen ap1=127.0.0.1:" +
                       std::to_string(port) + " --record ap1=" + path("ap1.pcap")),
            0);
  EXPECT_THAT(read("err"), HasSubstr("ap1 0/20"));
  EXPECT_GT(fs::file_size(path("ap1.pcap")), 1000U) << "they were heard";
}

TEST_F(SurveyVerb, ListensWhereTheDaemonWould) {
  const std::uint16_t port = free_port();
  std::ofstream(path("raylocd.toml"))
      << "schema = 1\n[site]\ndirectory = \"" << kSite << "\"\n[[source]]\nkind = \"udp\"\n"
      << "access_point = \"ap2\"\nlisten = \"127.0.0.1:" << port << "\"\n";
  const SimulatedDevice device(port);
  ASSERT_EQ(survey("0.5,0.2,1.2\nq\n", "--frames 3 --config " + path("raylocd.toml")), 0)
      << read("err");
  EXPECT_THAT(read("err"), HasSubstr("0.500,0.200,1.200: ap2 "));
  EXPECT_EQ(load_points_csv(path("points.csv"))->size(), 1U);
}

// The site of this directory, of several; another copy of it has to be named.
TEST_F(SurveyVerb, ListensWhereOneOfTheDaemonsSitesWould) {
  const std::array<std::uint16_t, 2> ports = {free_port(), free_port()};
  fs::create_directory(path("lab"));
  fs::copy(kSite, path("lab"), fs::copy_options::recursive);
  std::ofstream toml(path("raylocd.toml"));
  const std::array<std::string, 2> sites = {path("lab"), kSite};
  for (std::size_t i = 0; i < 2; ++i) {
    toml << "[[site]]\nname = \"room" << i << "\"\ndirectory = \"" << sites.at(i)
         << "\"\n[[source]]\nsite = \"room" << i
         << "\"\nkind = \"udp\"\naccess_point = \"ap2\"\nlisten = \"127.0.0.1:" << ports.at(i)
         << "\"\n";
  }
  toml.close();
  const SimulatedDevice lab(ports[0]);
  const SimulatedDevice device(ports[1]);
  const std::string config = "--frames 3 --config " + path("raylocd.toml");
  ASSERT_EQ(survey("0.5,0.2,1.2\nq\n", config), 0) << read("err");
  EXPECT_EQ(load_points_csv(path("points.csv"))->size(), 1U);
  ASSERT_EQ(survey("0.6,0.2,1.2\nq\n", config + " --site room0"), 0) << read("err");
  EXPECT_EQ(load_points_csv(path("points.csv"))->size(), 2U);
  EXPECT_EQ(survey("q\n", config + " --site attic"), 64);
  EXPECT_THAT(read("err"), HasSubstr("Write --site with one of: room0, room1"));
}

// As by Ctrl-C: what is written stays, the point under way is not written.
TEST_F(SurveyVerb, AnInterruptLeavesTheRowsBefore) {
  const std::uint16_t port = free_port();
  const SimulatedDevice device(port);
  std::ofstream(path("points.csv")) << "t_start,t_end,x,y,z\n1,2,0.1,0.2,1.2\n";
  std::array<int, 2> answers{};
  ASSERT_EQ(::pipe2(answers.data(), O_CLOEXEC), 0);
  const RaylocProcess process({"survey",
                               kSite,
                               "--frames",
                               "100000",
                               "--timeout",
                               "100000",
                               "--listen",
                               "ap1=127.0.0.1:" + std::to_string(port),
                               "--out",
                               path("points.csv")},
                              answers[0]);
  const std::string answer = "0.5,0.2,1.2\n";
  ASSERT_EQ(::write(answers[1], answer.data(), answer.size()), static_cast<ssize_t>(answer.size()));
  // With its answer taken, the point is under way.
  EXPECT_TRUE(eventually(kPatience, [&] {
    int unread = -1;
    return ::ioctl(answers[0], FIONREAD, &unread) == 0 && unread == 0;
  }));
  process.signal(SIGINT);
  const Finished finished = process.wait();
  ::close(answers[0]);
  ::close(answers[1]);
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("interrupted, not written"));
  EXPECT_THAT(finished.out, HasSubstr("\"points\":0"));
  EXPECT_EQ(read("points.csv"), "t_start,t_end,x,y,z\n1,2,0.1,0.2,1.2\n");
}

TEST_F(SurveyVerb, ContinuesOnlyAFileOfItsOwnKind) {
  std::ofstream(path("points.csv")) << "t_start,t_end,x,y,z\n1,2,0,0,1";
  EXPECT_EQ(survey("q\n", "--listen ap1=127.0.0.1:" + std::to_string(free_port())), 65);
  EXPECT_THAT(read("err"), HasSubstr("cannot be continued"));
  EXPECT_EQ(read("points.csv"), "t_start,t_end,x,y,z\n1,2,0,0,1");
}

TEST_F(SurveyVerb, NeedsAListenAddress) {
  EXPECT_EQ(survey("q\n", ""), 64);
  EXPECT_EQ(survey("q\n", "--listen ap9=127.0.0.1:1"), 64);
  EXPECT_THAT(read("err"), HasSubstr("ap1, ap2, ap3"));
  EXPECT_EQ(survey("q\n", "--listen ap1=pcap:a.pcap"), 64);
  EXPECT_THAT(read("err"), HasSubstr("pcap:a.pcap: is over already; listen at udp:HOST:PORT, "));
}

}  // namespace
}  // namespace rayloc::survey_test
