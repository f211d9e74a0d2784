// `rayloc frames` as a process of its own, on a real recording.
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/rayloc_process.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

const std::string kAllData = RAYLOC_TEST_DATA "/captures/axcsi-rt-ax86u/AllData.pcap";

std::vector<Json> lines_of(const std::string& text) {
  std::vector<Json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(Json::parse(line));
  }
  return lines;
}

TEST(Frames, PrintsTheKeysOfTheContract) {
  const Finished finished = RaylocProcess({"frames", "--json", "ap1=" + kAllData}).wait();
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.err, "");
  const std::vector<Json> lines = lines_of(finished.out);
  ASSERT_EQ(lines.size(), 37U);
  EXPECT_EQ(lines[0].dump(),
            R"({"time":"2018-05-05T06:11:11.306626Z","ap":"ap1","transmitter":"90:78:b2:b8:36:d5",)"
            R"("format":"axcsi-v4","phy":"vht","bandwidth_mhz":40,"sequence":543,)"
            R"("sequence_control":37600,"cores":[0,1,2,3],"streams":1,"tones":114,)"
            R"("power_dbm":[-43.0,-54.0,-48.0,-48.0],"complete":true,"flags":[]})");
  EXPECT_EQ(lines[36].dump(),
            R"({"summary":{"datagrams":144,"decoded":144,"duplicates":0,"late":0,"frames":36,)"
            R"("partial":0,"unrecorded":0,"rejected":{}}})");
}

TEST(Frames, ValuesAreAscendingAndRawIsAsOnTheWire) {
  const Json values = lines_of(RaylocProcess({"frames", "--values", kAllData}).wait().out).at(0);
  EXPECT_EQ(values["tone_index"].size(), 114U);
  EXPECT_EQ(values["tone_index"][0], -58);
  EXPECT_EQ(values["csi"].size(), 4U);
  EXPECT_EQ(values["csi"][3][0].size(), 114U);
  const Json raw =
      lines_of(RaylocProcess({"frames", "--values", "--raw", kAllData}).wait().out).at(0);
  EXPECT_EQ(raw["tone_index"].size(), 128U);
  // AXCSI.md's vector: word 0 is (115392, -10752), word 2 (184960, -199424), times 2^-16.
  EXPECT_EQ(raw["csi"][0][0][0].dump(), "[1.7607421875,-0.1640625]");
  EXPECT_EQ(raw["csi"][0][0][2].dump(), "[2.822265625,-3.04296875]");
  // Tone 2 was sent turned by j: undone, re' = im and im' = -re.
  EXPECT_EQ(values["tone_index"][57], 2);
  EXPECT_EQ(values["csi"][0][0][57].dump(), "[-3.04296875,-2.822265625]");
}

TEST(Frames, WithoutJsonALineIsForPeople) {
  const Finished finished = RaylocProcess({"frames", kAllData}).wait();
  EXPECT_NE(finished.out.find("vht 40 MHz  sequence 543/37600  cores 0,1,2,3"), std::string::npos);
  EXPECT_NE(finished.out.find("144 datagrams, 144 decoded"), std::string::npos);
}

TEST(Frames, SaysWhatIsWrongByExitStatus) {
  EXPECT_EQ(RaylocProcess({"frames"}).wait().status, 64);
  const Finished format = RaylocProcess({"frames", "--format", "axcsi", kAllData}).wait();
  EXPECT_EQ(format.status, 64);
  EXPECT_NE(format.err.find("axcsi-v4, nexmon-v1, nexmon-v2, ubilocate"), std::string::npos);
  EXPECT_NE(RaylocProcess({"frames", "/nonexistent.pcap"}).wait().status, 0);
  const Finished none =
      RaylocProcess({"frames", "--format", "ubilocate", "--json", kAllData}).wait();
  EXPECT_EQ(none.status, 65);
  EXPECT_EQ(lines_of(none.out).back()["summary"]["rejected"]["length_mismatch"], 144);
}

}  // namespace
}  // namespace rayloc
