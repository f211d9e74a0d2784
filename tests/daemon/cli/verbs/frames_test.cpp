// `rayloc frames` as a process of its own, on a made recording of 36 frames by four cores.
#include <complex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/pcap_files.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/wire_writer.h"

namespace rayloc::frames_test {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kSeconds = 1'525'500'671;  // 2018-05-05 06:11:11 UTC
constexpr std::uint32_t kMicroseconds = 306'626;
constexpr int kFrames = 36;

test::WireFrame first_frame() {
  test::WireFrame frame;
  frame.sequence = 543;
  frame.sequence_control = 37'600;
  return frame;
}

std::string write_recording() {
  const auto little = test::Endian::kLittle;
  test::ByteString file = test::pcap_header(little, false);
  test::WireFrame frame = first_frame();
  for (int i = 0; i < kFrames; ++i) {
    for (const auto& datagram : test::write_axcsi(frame, {})) {
      test::UdpPacket packet;
      packet.payload.assign(reinterpret_cast<const char*>(datagram.payload.data()),
                            datagram.payload.size());
      file += test::pcap_record(little,
                                kSeconds + static_cast<std::uint32_t>(i),
                                kMicroseconds,
                                test::ethernet(test::ipv4(packet)));
    }
    ++frame.sequence;
    frame.sequence_control = static_cast<std::uint16_t>(frame.sequence_control + 16);
  }
  std::string path = test::temporary_path("frames.pcap");
  test::write_file(path, file);
  return path;
}

const std::string& recording() {
  static const std::string kPath = write_recording();
  return kPath;
}

std::vector<Json> lines_of(const std::string& text) {
  std::vector<Json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(Json::parse(line));
  }
  return lines;
}

TEST(Frames, PrintsTheKeysOfTheContract) {
  const Finished finished = RaylocProcess({"frames", "--json", "ap1=" + recording()}).wait();
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.err, "");
  const std::vector<Json> lines = lines_of(finished.out);
  ASSERT_EQ(lines.size(), 37U);
  EXPECT_EQ(
      lines[0].dump(),
      R"({"time":"2018-05-05T06:11:11.306626Z","ap":"ap1","transmitter":"02:52:4c:00:00:01",)"
      R"("format":"axcsi-v4","phy":"vht","bandwidth_mhz":40,"sequence":543,)"
      R"("sequence_control":37600,"cores":[0,1,2,3],"streams":1,"tones":114,)"
      R"("power_dbm":[-41.0,-42.0,-43.0,-44.0],"complete":true,"flags":[],"centre_hz":5190000000.0})");
  EXPECT_EQ(lines[36].dump(),
            R"({"summary":{"datagrams":144,"decoded":144,"duplicates":0,"late":0,"frames":36,)"
            R"("partial":0,"unrecorded":0,"rejected":{}}})");
}

TEST(Frames, ValuesAreAscendingAndRawIsAsOnTheWire) {
  const Json values = lines_of(RaylocProcess({"frames", "--values", recording()}).wait().out).at(0);
  EXPECT_EQ(values["tone_index"].size(), 114U);
  EXPECT_EQ(values["tone_index"][0], -58);
  EXPECT_EQ(values["csi"].size(), 4U);
  EXPECT_EQ(values["csi"][3][0].size(), 114U);
  const Json raw =
      lines_of(RaylocProcess({"frames", "--values", "--raw", recording()}).wait().out).at(0);
  EXPECT_EQ(raw["tone_index"].size(), 128U);
  // Tone 2 was sent rotated by j: undone, re' = im and im' = -re.
  EXPECT_EQ(values["tone_index"][57], 2);
  const auto complex_of = [](const Json& pair) {
    return std::complex<double>(pair[0].get<double>(), pair[1].get<double>());
  };
  const std::complex<double> sent = complex_of(raw["csi"][0][0][2]);
  const std::complex<double> undone = complex_of(values["csi"][0][0][57]);
  EXPECT_EQ(undone, std::complex<double>(sent.imag(), -sent.real()));
  // Half a unit of an 11-bit mantissa, in each part.
  EXPECT_LT(std::abs(undone - first_frame().channel(0, 0, 2)), 100.0 / 2048);
}

TEST(Frames, WithoutJsonPrintsReadableLines) {
  const Finished finished = RaylocProcess({"frames", recording()}).wait();
  EXPECT_NE(finished.out.find("vht 40 MHz  sequence 543/37600  cores 0,1,2,3"), std::string::npos);
  EXPECT_NE(finished.out.find("144 datagrams, 144 decoded"), std::string::npos);
}

TEST(Frames, ReportsErrorsByExitStatus) {
  EXPECT_EQ(RaylocProcess({"frames"}).wait().status, 64);
  const Finished format = RaylocProcess({"frames", "--format", "axcsi", recording()}).wait();
  EXPECT_EQ(format.status, 64);
  EXPECT_NE(format.err.find("axcsi-v4, intel-5300, nexmon-v1, nexmon-v2, ubilocate"),
            std::string::npos);
  EXPECT_NE(RaylocProcess({"frames", "/nonexistent.pcap"}).wait().status, 0);
  const Finished none =
      RaylocProcess({"frames", "--format", "ubilocate", "--json", recording()}).wait();
  EXPECT_EQ(none.status, 65);
  EXPECT_EQ(lines_of(none.out).back()["summary"]["rejected"]["length_mismatch"], 144);
}

}  // namespace
}  // namespace rayloc::frames_test
