#include "daemon/lab/recordings/frame_lines.h"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/lab/recordings/frame_summary.h"

namespace rayloc::frame_lines_test {
namespace {

using Json = nlohmann::ordered_json;

// Two chains, one stream, three tones.
CsiFrame some_frame() {
  CsiFrame frame;
  frame.time = Timestamp(std::chrono::seconds(1'525'500'671));
  frame.transmitter = {{0x02, 0x52, 0x4c, 0x00, 0x00, 0x01}};
  frame.format = "axcsi-v4";
  frame.phy = PhyFormat::kVht;
  frame.bandwidth_mhz = 40;
  frame.sequence = 543;
  frame.sequence_control = 37'600;
  frame.rx_chains = {0, 2};
  frame.tone_index = {-1, 1, 2};
  frame.csi = Csi(2, 1, 3);
  frame.csi.row(1, 0)[2] = {0.5F, -0.25F};
  frame.power_dbm = {-41.0F, std::nullopt};
  frame.flags = {"missing_core"};
  return frame;
}

TEST(FrameLines, JsonHasTheKeysOfTheContract) {
  EXPECT_EQ(frame_json(some_frame(), "ap1", false),
            R"({"time":"2018-05-05T06:11:11.000000Z","ap":"ap1","transmitter":"02:52:4c:00:00:01",)"
            R"("format":"axcsi-v4","phy":"vht","bandwidth_mhz":40,"sequence":543,)"
            R"("sequence_control":37600,"cores":[0,2],"streams":1,"tones":3,)"
            R"("power_dbm":[-41.0,null],"complete":false,"flags":["missing_core"]})");
  CsiFrame on_channel = some_frame();
  on_channel.channel = RadioChannel{5.19e9, 40};
  EXPECT_EQ(Json::parse(frame_json(on_channel, "ap1", false))["centre_hz"], 5.19e9);
}

TEST(FrameLines, ValuesAreByCoreStreamAndTone) {
  const Json line = Json::parse(frame_json(some_frame(), "ap1", true));
  EXPECT_EQ(line["tone_index"], Json({-1, 1, 2}));
  ASSERT_EQ(line["csi"].size(), 2U);
  EXPECT_EQ(line["csi"][1][0][2], Json({0.5, -0.25}));
}

TEST(FrameLines, TextIsForPeople) {
  const std::string line = frame_text(some_frame(), "ap1");
  EXPECT_NE(line.find("vht 40 MHz  sequence 543/37600  cores 0,2  streams 1  tones 3  -41,? dBm"),
            std::string::npos)
      << line;
  EXPECT_NE(line.find("  incomplete  missing_core"), std::string::npos) << line;
}

TEST(FrameSummary, AddsTheOutcomeOfEveryDatagram) {
  SourceCounters source;
  source.received = 10;
  source.rejected["gap_mark"] = 1;
  source.unrecorded = 5;
  CsiReceiverCounters receiver;
  receiver.in_frames = 5;
  receiver.duplicates = 2;
  receiver.late = 1;
  receiver.frames = 2;
  receiver.rejected["length_mismatch"] = 1;
  FrameSummary summary;
  summary.add(source, receiver);
  EXPECT_EQ(summary_json(summary),
            R"({"summary":{"datagrams":10,"decoded":8,"duplicates":2,"late":1,"frames":2,)"
            R"("partial":0,"unrecorded":5,"rejected":{"gap_mark":1,"length_mismatch":1}}})");
  EXPECT_EQ(summary_text(summary),
            "10 datagrams, 8 decoded (2 duplicates, 1 late), 2 frames, 0 partial, 1 rejected: "
            "gap_mark, 1 rejected: length_mismatch; marked in the recording as not recorded: 5");
}

}  // namespace
}  // namespace rayloc::frame_lines_test
