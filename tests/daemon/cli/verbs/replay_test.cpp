// Tests the messages of `rayloc replay` for wrong calls, and how a replay continues another one;
// its results are tested in tests/e2e.
#include <unistd.h>

#include <regex>

#include <gtest/gtest.h>

#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"
#include "tests/support/verb_folder.h"

namespace rayloc::replay_test {
namespace {

const std::string kSite = test::data_path("/sites/meeting_room");
const std::string kRecording = kSite + "/device_los-ap1.pcap.gz";

Finished replay(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "replay");
  return RaylocProcess(std::move(arguments)).wait();
}

TEST(Replay, NeedsTheAccessPointOfEachRecording) {
  const Finished finished = replay({kSite, kRecording});
  EXPECT_EQ(finished.status, 64);
  EXPECT_NE(finished.err.find("ap1, ap2, ap3"), std::string::npos) << finished.err;
}

TEST(Replay, RefusesOptionsThatMeanNothing) {
  const std::string capture = "ap1=" + kRecording;
  for (const auto& [option, value] : {std::pair{"--burst", "fast"},
                                      std::pair{"--burst", "2h"},
                                      std::pair{"--burst", "nan"},
                                      std::pair{"--speed", "0"},
                                      std::pair{"--speed", "1x"},
                                      std::pair{"--method", "magic"},
                                      std::pair{"--multi-start", "0"},
                                      std::pair{"--multi-start", "2"},  // of method rayloc
                                      std::pair{"--paper", "alpha=1"},
                                      std::pair{"--tracks", "clouds"}}) {
    const Finished finished = replay({kSite, capture, option, value});
    EXPECT_EQ(finished.status, 64) << option << " " << value;
    EXPECT_NE(finished.err.find(option), std::string::npos) << finished.err;
    EXPECT_EQ(finished.out, "");
  }
}

TEST(Replay, RefusesTracksThatTheMethodDoesNotHave) {
  const std::vector<std::string> cloud = {kSite, "ap1=" + kRecording, "--tracks", "cloud"};
  for (const auto& [more, named] :
       {std::pair<std::vector<std::string>, std::string>{{"--method", "spotfi"}, "spotfi"},
        std::pair<std::vector<std::string>, std::string>{{"--exhaustive"}, "--exhaustive"}}) {
    std::vector<std::string> arguments = cloud;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished finished = replay(arguments);
    EXPECT_EQ(finished.status, 64) << named;
    EXPECT_NE(finished.err.find("--tracks: "), std::string::npos) << finished.err;
    EXPECT_NE(finished.err.find(named), std::string::npos) << finished.err;
    EXPECT_EQ(finished.out, "");
  }
}

TEST(Replay, RefusesSettingsThatThePaperDoesNotHave) {
  const std::string capture = "ap1=" + kRecording;
  const Finished finished =
      replay({kSite, capture, "--method", "paper", "--paper", "smoothing=false", "alhpa=1"});
  EXPECT_EQ(finished.status, 64);
  EXPECT_NE(finished.err.find("--paper alhpa=1: method paper has no 'alhpa'"), std::string::npos)
      << finished.err;
}

TEST(Replay, NamesTheFileThatCannotBeRead) {
  EXPECT_EQ(replay({kSite, "ap1=missing.pcap"}).status, 69);
  const Finished finished = replay({kSite, "ap1=" + kSite + "/site.toml"});
  EXPECT_EQ(finished.status, 65);
  EXPECT_NE(finished.err.find("site.toml"), std::string::npos) << finished.err;
  EXPECT_EQ(replay({"nowhere", "x.pcap"}).status, 78);
}

TEST(Field, AReplayThatLocatesNothingEndsWithTheReason) {
  const Finished finished =
      replay({kSite, "ap1=" + kRecording, "--burst", "2s", "--no-cache", "--out", "/dev/null"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  std::smatch found;
  ASSERT_TRUE(std::regex_search(
      finished.err,
      found,
      std::regex("\n([0-9]+) without a fix: no chain gains, calibrate the site \\(([0-9]+)\\)\n")))
      << finished.err;
  EXPECT_EQ(found[1], found[2]);
  EXPECT_NE(finished.err.find("rayloc replay: nothing can be located: the access points in use are "
                              "not calibrated (ap1)"),
            std::string::npos)
      << finished.err;
}

TEST(Replay, StatesNoFixWithoutACalibration) {
  const Finished finished =
      replay({kSite, "ap1=" + kRecording, "--burst", "2s", "--tracks", "cloud", "--quiet"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("FIX_MODE_NO_FIX"), std::string::npos);
  EXPECT_EQ(finished.out.find("\"position\""), std::string::npos);
  EXPECT_NE(finished.out.find("no_fix_reason"), std::string::npos);
}

TEST(Replay, ReportsTheRequestedMethod) {
  for (const std::string method : {"rayloc", "paper"}) {
    const Finished finished =
        replay({kSite, "ap1=" + kRecording, "--burst", "2s", "--quiet", "--method", method});
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_NE(finished.out.find("\"method\":\"" + method + "\""), std::string::npos) << method;
  }
}

TEST(Replay, RefusesUnusableCarriedState) {
  const std::string capture = "ap1=" + kRecording;
  const Finished time = replay({kSite, capture, "--from", "yesterday"});
  EXPECT_EQ(time.status, 64);
  EXPECT_NE(time.err.find("--from yesterday"), std::string::npos) << time.err;
  EXPECT_EQ(replay({kSite, capture, "--carried", "missing.jsonl"}).status, 65);
}

class CutReplay : public test::VerbFolder {
 protected:
  CutReplay() : VerbFolder("rayloc_cut_replay." + std::to_string(::getpid())) {}

  std::string replayed(std::vector<std::string> more) const {
    std::vector<std::string> arguments{
        "replay", kSite, "ap1=" + kRecording, "--quiet", "--no-cache"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
};

// Without a calibration each burst states only its start and end. A replay that continues from a
// carried record prints the same bytes as the rest of the whole replay.
TEST_F(CutReplay, ContinuesFromCarriedState) {
  const std::string whole = replayed({"--carried-out", path("carried.jsonl")});
  const std::string rest =
      replayed({"--carried", path("carried.jsonl"), "--from", "2024-06-10T06:30:00Z"});
  ASSERT_GT(rest.size(), 10'000U);
  ASSERT_LT(rest.size(), whole.size());
  EXPECT_EQ(rest, whole.substr(whole.size() - rest.size()));
  const std::string last = replayed({"--carried", path("carried.jsonl")});
  ASSERT_LT(last.size(), rest.size());
  EXPECT_EQ(last, whole.substr(whole.size() - last.size()));
}

}  // namespace
}  // namespace rayloc::replay_test
