#include "daemon/live/machine/source_hints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/pipeline/frame_census.h"

namespace rayloc::source_hints_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Site site_of_three_rx_chains() {
  Site site;
  site.carrier.bandwidth_mhz = 40;
  SiteAccessPoint access_point;
  access_point.id = "ap1";
  access_point.format = "axcsi-v4";
  access_point.rx_chains = {0, 2, 3};
  site.access_points.push_back(access_point);
  return site;
}

v1::SourceState healthy() {
  v1::SourceState source;
  source.set_access_point("ap1");
  source.set_status(v1::SOURCE_STATUS_RECEIVING);
  source.set_description("udp 0.0.0.0:5500");
  source.set_format("axcsi-v4");
  source.mutable_counters()->set_received(3000);
  source.mutable_counters()->set_frames_complete(1000);
  (*source.mutable_frames_by_bandwidth_mhz())[40] = 1000;
  for (const std::uint32_t rx_chain : {0U, 2U, 3U}) {
    v1::CoreReport* report = source.add_cores();
    report->set_core(rx_chain);
    report->set_frames(1000);
    report->set_below_strongest_db(rx_chain);
  }
  return source;
}

std::vector<std::string> hints_of(const v1::SourceState& source) {
  std::vector<std::string> lines;
  for (const Finding& finding : source_hints(source, site_of_three_rx_chains())) {
    EXPECT_NE(finding.kind, Finding::Kind::kOk);
    EXPECT_FALSE(finding.advice.empty()) << finding.what;
    lines.push_back(finding.what);
  }
  return lines;
}

TEST(SourceHints, AreEmptyForHealthySources) { EXPECT_THAT(hints_of(healthy()), IsEmpty()); }

TEST(Field, HintsNameACaptureInMonitorModeAndBlameNoFormatForStamps) {
  v1::SourceState source = healthy();
  auto& rejected = *source.mutable_counters()->mutable_rejected();
  rejected["damaged_time"] = 1500;
  rejected["time_went_back"] = 1500;
  EXPECT_THAT(hints_of(source), IsEmpty());
  rejected["monitor_mode"] = 20;
  EXPECT_THAT(
      hints_of(source),
      ElementsAre(HasSubstr("20 packets are frames of the air, of an interface in monitor")));
}

TEST(Field, HintsNameAnotherChannelAndSeveralAccessPoints) {
  for (const char* reason : {"other_channel", "several_access_points"}) {
    v1::SourceState source = healthy();
    (*source.mutable_counters()->mutable_rejected())[reason] = 2900;
    source.set_detail("both are named here");
    const std::vector<Finding> found = source_hints(source, site_of_three_rx_chains());
    ASSERT_EQ(found.size(), 1U) << "no complaint about the format";
    EXPECT_EQ(found[0].kind, Finding::Kind::kProblem);
    EXPECT_THAT(found[0].what, HasSubstr("2900 datagrams rejected"));
    EXPECT_THAT(found[0].what, HasSubstr("both are named here"));
    EXPECT_FALSE(found[0].advice.empty());
    source.clear_detail();
    EXPECT_EQ(source_hints(source, site_of_three_rx_chains()).at(0).kind, Finding::Kind::kWarning)
        << "it is over";
  }
}

TEST(Field, HintsNameTunnelsFragmentsAndCutPacketsInsteadOfAnotherFormat) {
  for (const auto& [reason, text] :
       std::map<std::string, std::string>{{"tunnel_vxlan", "VXLAN"},
                                          {"tunnel_erspan", "ERSPAN"},
                                          {"ip_fragment", "MTU"},
                                          {"truncated_capture", "snapshot length"}}) {
    v1::SourceState source = healthy();
    auto& rejected = *source.mutable_counters()->mutable_rejected();
    rejected[reason] = source.counters().received() / 2;
    EXPECT_THAT(hints_of(source), ElementsAre(HasSubstr(text)));
    rejected[reason] = 1;
    EXPECT_THAT(hints_of(source), IsEmpty()) << "of another program";
  }
}

TEST(SourceHints, ReportSilentSources) {
  v1::SourceState source = healthy();
  source.set_status(v1::SOURCE_STATUS_STALLED);
  source.mutable_age()->set_seconds(70);
  EXPECT_THAT(hints_of(source), ElementsAre("source ap1: silent for 70 s"));
  v1::SourceState waiting;
  waiting.set_access_point("ap1");
  waiting.set_status(v1::SOURCE_STATUS_WAITING);
  waiting.set_description("udp 0.0.0.0:5500");
  EXPECT_THAT(hints_of(waiting),
              ElementsAre("source ap1: nothing has come yet at udp 0.0.0.0:5500"));
}

TEST(SourceHints, AnotherFormatOrNoCsiAtAll) {
  v1::SourceState source = healthy();
  source.set_format("nexmon");
  (*source.mutable_counters()->mutable_rejected())["unknown_format"] = 300;
  EXPECT_THAT(hints_of(source),
              ElementsAre("source ap1: 300 of 3000 datagrams are no CSI that is known "
                          "(300 unknown_format)",
                          "source ap1: it sends nexmon, the site states axcsi-v4"));
  (*source.mutable_counters()->mutable_rejected())["unknown_format"] = 299;
  source.set_format("axcsi-v4");
  EXPECT_THAT(hints_of(source), IsEmpty()) << "a stray datagram is no finding";
}

TEST(SourceHints, ExplainDatagramsRejectedByTheConfiguration) {
  v1::SourceState source;
  source.set_access_point("ap1");
  source.set_status(v1::SOURCE_STATUS_WAITING);
  source.mutable_counters()->set_received(600);
  (*source.mutable_counters()->mutable_rejected())["sender_not_allowed"] = 500;
  (*source.mutable_counters()->mutable_rejected())["interface_not_allowed"] = 100;
  EXPECT_THAT(hints_of(source),
              ElementsAre("source ap1: 500 datagrams come from addresses that are not allowed, and "
                          "no frame has come",
                          "source ap1: 100 datagrams come through another interface, and no frame "
                          "has come"));
  source = healthy();
  (*source.mutable_counters()->mutable_rejected())["sender_not_allowed"] = 3000;
  EXPECT_THAT(hints_of(source), IsEmpty()) << "others may send there";
}

TEST(SourceHints, ReportMissingRareDeadAndUnknownRxChains) {
  v1::SourceState source = healthy();
  source.mutable_cores(0)->set_frames(0);
  source.mutable_cores(1)->set_frames(800);
  source.mutable_cores(2)->set_below_strongest_db(33.0);
  v1::CoreReport* unknown = source.add_cores();
  unknown->set_core(1);
  unknown->set_frames(1000);
  EXPECT_THAT(
      hints_of(source),
      ElementsAre(
          "source ap1: no frame has core 0, which site.toml names",
          "source ap1: core 2 is in 800 of 1000 frames only",
          "source ap1: core 3 receives 33 dB less than the strongest: its antenna may be dead",
          "source ap1: core 1 comes and is not in site.toml"));
}

TEST(SourceHints, TornFramesAndAnotherBandwidth) {
  v1::SourceState source = healthy();
  source.mutable_counters()->set_frames_complete(800);
  source.mutable_counters()->set_frames_partial(200);
  source.mutable_frames_by_bandwidth_mhz()->clear();
  (*source.mutable_frames_by_bandwidth_mhz())[80] = 900;
  (*source.mutable_frames_by_bandwidth_mhz())[40] = 100;
  EXPECT_THAT(hints_of(source),
              ElementsAre("source ap1: 200 of 1000 frames lack a part",
                          "source ap1: 100 of 1000 frames have the 40 MHz of site.toml (900 with "
                          "80 MHz)"));
}

TEST(Field, HintsNameAddressesThatNoDeviceHas) {
  v1::SourceState source = healthy();
  auto& rejected = *source.mutable_counters()->mutable_rejected();
  rejected["group_address"] = 1200;
  rejected["zero_address"] = 3;
  EXPECT_THAT(hints_of(source),
              ElementsAre(::testing::AllOf(HasSubstr("1203 of 3000"), HasSubstr("group address"))));
}

TEST(FrameCensus, DistinguishesADeadChainFromAFadingOne) {
  FrameCensus census;
  for (int i = 0; i < 200; ++i) {
    CsiFrame frame;
    frame.format = "axcsi-v4";
    frame.bandwidth_mhz = i < 150 ? 40 : 20;
    frame.rx_chains = {0, 1, 3};
    frame.csi = Csi(3, 1, 4);
    const float faded = i % 2 == 0 ? 0.1F : 1.0F;  // 20 dB in every second frame
    for (std::size_t tone = 0; tone < 4; ++tone) {
      frame.csi.row(0, 0)[tone] = 1.0F;
      frame.csi.row(1, 0)[tone] = faded;
      frame.csi.row(2, 0)[tone] = 0.01F;
    }
    census.add(std::span(&frame, 1));
  }
  EXPECT_EQ(census.format, "axcsi-v4");
  EXPECT_EQ(census.frames_by_bandwidth_mhz.at(40), 150U);
  EXPECT_EQ(census.frames_by_bandwidth_mhz.at(20), 50U);
  EXPECT_EQ(census.rx_chains.at(3).frames, 200U);
  EXPECT_NEAR(census.rx_chains.at(0).below_strongest_db, 0.0, 1e-6);
  EXPECT_NEAR(census.rx_chains.at(1).below_strongest_db, 10.0, 1.0);
  EXPECT_NEAR(census.rx_chains.at(3).below_strongest_db, 40.0, 1e-3);
}

}  // namespace
}  // namespace rayloc::source_hints_test
