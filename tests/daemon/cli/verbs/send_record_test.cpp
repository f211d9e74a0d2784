// `rayloc send` and `rayloc record` as processes of their own, over real sockets.
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "capture/source/udp_source.h"
#include "capture/source/unix_source.h"
#include "tests/support/eventually.h"
#include "tests/support/pcap_files.h"
#include "tests/support/test_paths.h"

namespace rayloc::send_record_test {
namespace {

using ::testing::HasSubstr;

struct Outcome {
  int status = -1;
  std::string output;
};

Outcome rayloc(const std::string& arguments) {
  const std::string command = test::program_path("rayloc") + " " + arguments;
  std::FILE* pipe = popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    outcome.output.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

std::vector<nlohmann::json> json_lines(const std::string& text) {
  std::vector<nlohmann::json> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    lines.push_back(nlohmann::json::parse(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return lines;
}

// Payloads at milliseconds after kFirst.
constexpr std::uint32_t kFirst = 1525500671;
std::string recording(const std::string& name,
                      const std::vector<std::pair<std::uint32_t, std::string>>& payloads) {
  const auto little = test::Endian::kLittle;
  std::string file = test::pcap_header(little, false);
  for (const auto& [milliseconds, payload] : payloads) {
    file += test::pcap_record(little,
                              kFirst + milliseconds / 1000,
                              milliseconds % 1000 * 1000,
                              test::ethernet(test::ipv4({.payload = payload})));
  }
  std::string path = test::temporary_path(name);
  test::write_file(path, file);
  return path;
}

struct Received {
  Timestamp time;
  std::string payload;
};

class Port {
 public:
  Port() {
    auto source = UdpSource::open({.address = "127.0.0.1:0"});
    EXPECT_TRUE(source) << source.error().message;
    source_ = std::move(*source);
  }
  std::string address() const { return "127.0.0.1:" + std::to_string(source_->port()); }
  // Returns the datagrams that have arrived by now.
  std::vector<Received> receive() {
    std::vector<Received> all;
    DatagramBatch batch;
    do {
      EXPECT_TRUE(source_->read(batch, Duration(0)));
      for (const Datagram& d : batch.datagrams) {
        const auto* bytes = reinterpret_cast<const char*>(d.payload.data());
        all.push_back({d.time, std::string(bytes, d.payload.size())});
      }
    } while (!batch.datagrams.empty());
    return all;
  }

 private:
  std::unique_ptr<UdpSource> source_;
};

Timestamp recorded(std::uint32_t milliseconds) {
  return Timestamp(std::chrono::seconds(kFirst) + std::chrono::milliseconds(milliseconds));
}

// No datagram is early; how late one is depends on the machine.
constexpr Duration kClockReading = std::chrono::milliseconds(1);

TEST(Send, KeepsTheTimesOfSeveralRecordingsByOneOffset) {
  Port a;
  Port b;
  const std::string file_a = recording("send_a.pcap", {{0, "a0"}, {120, "a120"}});
  const std::string file_b = recording("send_b.pcap", {{60, "b60"}});
  const Outcome outcome = rayloc("send " + file_a + " " + file_b + " --to " + a.address() +
                                 " --to " + b.address() + " 2>/dev/null");
  ASSERT_EQ(outcome.status, 0);
  const auto lines = json_lines(outcome.output);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].at("event"), "start");
  EXPECT_EQ(lines[1].at("event"), "end");
  EXPECT_EQ(lines[1].at("datagrams"), 3);
  EXPECT_EQ(lines[1].at("bytes"), 9);
  const Duration offset = from_seconds(lines[0].at("time_offset_s").get<double>());
  const auto at_a = a.receive();
  const auto at_b = b.receive();
  ASSERT_EQ(at_a.size(), 2U);
  ASSERT_EQ(at_b.size(), 1U);
  EXPECT_EQ(at_a[0].payload, "a0");
  EXPECT_EQ(at_a[1].payload, "a120");
  EXPECT_EQ(at_b[0].payload, "b60");
  EXPECT_GE(at_a[0].time, recorded(0) + offset - kClockReading);
  EXPECT_GE(at_b[0].time, recorded(60) + offset - kClockReading);
  EXPECT_GE(at_a[1].time, recorded(120) + offset - kClockReading);
  EXPECT_LE(at_a[1].time, recorded(120) + offset + test::patient(std::chrono::minutes(1)));
  unlink(file_a.c_str());
  unlink(file_b.c_str());
}

// A clock that was set by a day, or a device that was away for a day: with --max-gap 0.1 the gap
// takes 0.1 s instead of a day.
TEST(Field, SendDoesNotWaitForAGap) {
  Port port;
  constexpr std::uint32_t kDay = 86'400'000;
  const std::string file = recording(
      "send_gap.pcap", {{0, "a"}, {10, "b"}, {kDay, "c"}, {kDay + 10, "d"}, {kDay + 20, "e"}});
  const Outcome outcome =
      rayloc("send " + file + " --to " + port.address() + " --max-gap 0.1 2>/dev/null");
  ASSERT_EQ(outcome.status, 0);
  const auto lines = json_lines(outcome.output);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[1].at("event"), "gap");
  EXPECT_NEAR(lines[1].at("gap_s").get<double>(), 86399.99, 1e-6);
  EXPECT_NEAR(lines[1].at("skipped_s").get<double>(), 86399.89, 1e-6);
  EXPECT_EQ(lines[2].at("rejected"), nlohmann::json::object());
  const auto all = port.receive();
  ASSERT_EQ(all.size(), 5U);
  // Datagrams after the gap arrive at the offset that the gap event states.
  const Duration offset = from_seconds(lines[1].at("time_offset_s").get<double>());
  EXPECT_EQ(all[2].payload, "c");
  EXPECT_GE(all[2].time, recorded(kDay) + offset - kClockReading);
  EXPECT_LE(all[2].time, recorded(kDay) + offset + test::patient(std::chrono::minutes(1)));
  unlink(file.c_str());
}

TEST(Field, SendTakesFilesOfOneAccessPointAsOneRecording) {
  Port a;
  Port b;
  const std::string first = recording("send_ring.pcap0", {{0, "1"}, {10, "2"}});
  const std::string second = recording("send_ring.pcap1", {{20, "3"}, {30, "4"}});
  const std::string other = recording("send_other.pcap", {{15, "x"}});
  const Outcome outcome = rayloc("send ap1=" + second + " ap2=" + other + " ap1=" + first +
                                 " --to " + a.address() + " --to " + b.address() + " 2>/dev/null");
  ASSERT_EQ(outcome.status, 0);
  std::string payloads;
  for (const Received& one : a.receive()) {
    payloads += one.payload;
  }
  EXPECT_EQ(payloads, "1234");
  EXPECT_EQ(b.receive().size(), 1U);
  const Outcome many = rayloc("send " + first + " " + second + " --to 127.0.0.1:1 2>&1");
  EXPECT_EQ(many.status, 64);
  EXPECT_THAT(many.output, HasSubstr("2 recordings and 1 destinations"));
  for (const std::string& file : {first, second, other}) {
    unlink(file.c_str());
  }
}

TEST(Field, SendOmitsAndReportsADamagedStamp) {
  Port port;
  const std::string file =
      recording("send_damaged.pcap", {{0, "a"}, {10, "b"}, {3'600'000, "c"}, {20, "d"}, {30, "e"}});
  const Outcome outcome = rayloc("send " + file + " --to " + port.address() + " 2>&1 >/dev/null");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output, HasSubstr("packet 3 (byte "));
  EXPECT_THAT(outcome.output, HasSubstr("packets rejected: 1 damaged_time"));
  EXPECT_EQ(port.receive().size(), 4U);
  unlink(file.c_str());
}

TEST(Send, RepeatsTheRecordingAtARate) {
  Port port;
  const std::string file = recording("send_rate.pcap", {{0, "x"}, {1, "y"}, {2, "z"}});
  const Outcome outcome = rayloc("send " + file + " --to " + port.address() +
                                 " --rate 1000 --duration 0.2 2>/dev/null");
  ASSERT_EQ(outcome.status, 0);
  const auto lines = json_lines(outcome.output);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[0].at("time_offset_s").is_null());
  const auto all = port.receive();
  EXPECT_EQ(lines[1].at("datagrams"), all.size());
  EXPECT_LE(all.size(), 200U);
  ASSERT_GE(all.size(), 4U);
  EXPECT_EQ(all[0].payload + all[1].payload + all[2].payload + all[3].payload, "xyzx");
  unlink(file.c_str());
}

TEST(Send, ReportsInvalidArgumentsAndFiles) {
  EXPECT_EQ(rayloc("send x.pcap y.pcap --to 127.0.0.1:1 2>/dev/null").status, 64);
  EXPECT_EQ(rayloc("send x.pcap --to nowhere 2>/dev/null").status, 64);
  EXPECT_EQ(rayloc("send x.pcap --to 127.0.0.1:1 --speed 0 2>/dev/null").status, 64);
  const Outcome missing = rayloc("send /nowhere/x.pcap --to 127.0.0.1:1 2>&1");
  EXPECT_EQ(missing.status, 69);
  EXPECT_THAT(missing.output, HasSubstr("/nowhere/x.pcap"));
  const std::string garbage = test::temporary_path("garbage.pcap");
  test::write_file(garbage, "this is no capture");
  const Outcome bad = rayloc("send " + garbage + " --to 127.0.0.1:1 2>&1");
  EXPECT_EQ(bad.status, 65);
  EXPECT_THAT(bad.output, HasSubstr(garbage + ": byte 0"));
  unlink(garbage.c_str());
}

// A port that is free now; another program could take it, which the recorder would report.
std::string free_address() { return Port().address(); }

TEST(Record, WritesTheDatagramsOfSend) {
  const std::string address = free_address();
  const std::string sent = recording("record_in.pcap", {{0, "one"}, {1, ""}, {2, "three"}});
  const std::string out = test::temporary_path("record_out.pcap");
  unlink(out.c_str());
  Outcome outcome;
  std::thread recorder([&] {
    outcome = rayloc("record --udp " + address + " --out " + out +
                     " --count 3 --duration 120 2>/dev/null");
  });
  // The file is there once the port is open.
  EXPECT_TRUE(eventually(std::chrono::seconds(60), [&] { return access(out.c_str(), F_OK) == 0; }));
  EXPECT_EQ(rayloc("send " + sent + " --to " + address + " >/dev/null 2>&1").status, 0);
  recorder.join();
  ASSERT_EQ(outcome.status, 0);
  const auto lines = json_lines(outcome.output);
  ASSERT_EQ(lines.size(), 1U);
  const auto& summary = lines[0].at("summary");
  EXPECT_EQ(summary.at("received"), 3);
  EXPECT_EQ(summary.at("recorded"), 3);
  EXPECT_EQ(summary.at("lost"), 0);
  EXPECT_EQ(summary.at("file_bytes"), test::read_file(out).size());

  Port port;
  EXPECT_EQ(
      rayloc("send " + out + " --to " + port.address() + " --speed max >/dev/null 2>&1").status, 0);
  const auto all = port.receive();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].payload + "," + all[1].payload + "," + all[2].payload, "one,,three");
  EXPECT_EQ(rayloc("record --udp " + address + " --out " + out + " 2>/dev/null").status, 69)
      << "an existing recording is not overwritten";
  unlink(sent.c_str());
  unlink(out.c_str());
}

TEST(Send, AFileIsASinkAndASourceLikeAnyOther) {
  const std::string file = recording("transport_in.pcap", {{0, "one"}, {1, "two"}});
  const std::string sent = test::temporary_path("transport_sent.pcap");
  const std::string copied = test::temporary_path("transport_copied.pcap");
  unlink(sent.c_str());
  unlink(copied.c_str());
  EXPECT_EQ(rayloc("send pcap:" + file + " --to pcap:" + sent + " 2>/dev/null >&2").status, 0);
  const Outcome outcome =
      rayloc("record --from pcap:" + sent + " --out pcap:" + copied + " 2>/dev/null");
  ASSERT_EQ(outcome.status, 0);
  const auto summary = json_lines(outcome.output).at(0).at("summary");
  EXPECT_EQ(summary.at("recorded"), 2);
  EXPECT_EQ(summary.at("file_bytes"), test::read_file(copied).size());
  EXPECT_EQ(test::read_file(copied), test::read_file(sent));
  Port port;
  EXPECT_EQ(rayloc("send " + copied + " --to udp:" + port.address() + " 2>/dev/null >&2").status,
            0);
  const auto all = port.receive();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].payload + all[1].payload, "onetwo");
  for (const std::string& one : {file, sent, copied}) {
    unlink(one.c_str());
  }
}

TEST(Send, ReachesTheSocketOfADaemon) {
  const std::string path = test::temporary_path("send_unix.socket");
  const std::string file = recording("send_unix.pcap", {{0, "a"}, {1, "b"}});
  const std::string command = "send " + file + " --to unix:" + path + " 2>/dev/null";
  const Outcome absent = rayloc(command);
  EXPECT_EQ(absent.status, 0);
  EXPECT_EQ(json_lines(absent.output).back().at("lost"), nlohmann::json({{"not_there", 2}}));
  auto source = UnixSource::open({.path = path});
  ASSERT_TRUE(source) << source.error().message;
  const Outcome outcome = rayloc(command);
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(json_lines(outcome.output).back().at("datagrams"), 2);
  EXPECT_FALSE(json_lines(outcome.output).back().contains("lost"));
  std::size_t received = 0;
  EXPECT_TRUE(eventually(std::chrono::seconds(60), [&] {
    DatagramBatch batch;
    EXPECT_TRUE((*source)->read(batch, std::chrono::milliseconds(100)));
    received += batch.datagrams.size();
    return received == 2;
  }));
  unlink(file.c_str());
}

TEST(Send, AnUnknownTransportListsThoseThereAre) {
  const Outcome to = rayloc("send x.pcap --to nats:lab 2>&1");
  EXPECT_EQ(to.status, 64);
  EXPECT_THAT(to.output, HasSubstr("'nats' is no transport either; there are: udp, pcap, unix"));
  const Outcome from = rayloc("record --from nats:lab --out x.pcap 2>&1");
  EXPECT_EQ(from.status, 64);
  EXPECT_THAT(from.output, HasSubstr("there is no transport 'nats'; there are: udp, pcap, unix"));
  const Outcome live = rayloc("send udp:127.0.0.1:0 --to 127.0.0.1:1 2>&1");
  EXPECT_EQ(live.status, 64);
  EXPECT_THAT(live.output, HasSubstr("rayloc record --from udp:127.0.0.1:0 passes on"));
  for (const char* verb : {"send", "record", "survey"}) {
    EXPECT_THAT(rayloc(std::string(verb) + " --help").output, HasSubstr("udp:HOST:PORT")) << verb;
  }
}

TEST(Record, ReportsInvalidArguments) {
  EXPECT_EQ(rayloc("record --out x.pcap 2>/dev/null").status, 64);
  EXPECT_EQ(rayloc("record --interface nowhere0 --out x.pcap 2>/dev/null").status, 69);
  const Port taken;
  EXPECT_EQ(rayloc("record --udp " + taken.address() + " --out x.pcap 2>/dev/null").status, 69);
}

}  // namespace
}  // namespace rayloc::send_record_test
