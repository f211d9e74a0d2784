// `rayloc scene show` as a process of its own.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::scene_show_test {
namespace {

namespace fs = std::filesystem;

const std::string kSite = test::data_path("/sites/meeting_room");
const std::string kCorridor = test::data_path("/scenes/corridor/scene.xml");

class SceneShow : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rayloc-show-test." + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string out(const std::string& name) const { return folder_ / name; }

  Finished show(std::vector<std::string> arguments, const std::string& name) const {
    arguments.insert(arguments.begin(), {"scene", "show"});
    arguments.insert(arguments.end(), {"--out", out(name)});
    return RaylocProcess(std::move(arguments)).wait();
  }
  std::set<std::string> texts_in(const std::string& name) const {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_file(out(name).c_str()));
    std::set<std::string> texts;
    for (const pugi::xml_node& text : document.child("svg").children("text")) {
      texts.insert(text.child_value());
    }
    return texts;
  }

  fs::path folder_;
};

TEST_F(SceneShow, DrawsASiteWithItsAccessPoints) {
  const Finished finished = show({kSite}, "room.svg");
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.out, "");
  EXPECT_EQ(finished.err, "");
  const std::set<std::string> texts = texts_in("room.svg");
  for (const char* text : {"meeting_room", "ap1", "ap2", "ap3", "table", "wall_north"}) {
    EXPECT_TRUE(texts.contains(text)) << text;
  }
  EXPECT_FALSE(texts.contains("Power of a path"));
}

TEST_F(SceneShow, DrawsThePathsOfADeviceToAnAccessPoint) {
  const Finished finished = show(
      {kSite, "--tx", "0.95,0.25,1.2", "--ap", "ap3", "--depth", "1", "--view", "3d"}, "room.svg");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const std::set<std::string> texts = texts_in("room.svg");
  EXPECT_TRUE(texts.contains("tx"));
  EXPECT_FALSE(texts.contains("rx"));
  EXPECT_TRUE(texts.contains("Power of a path"));
  EXPECT_TRUE(texts.contains("3.77 x 3.09 x 2.94 m, 19 objects, 5.19 GHz, 6 paths to depth 1"));
}

TEST_F(SceneShow, OmitsWeakPathsAndReportsTheirCount) {
  const std::vector<std::string> link{
      kCorridor, "--tx", "-3,0.3,1.2", "--rx", "9,-0.5,2", "--depth", "1", "--range", "6"};
  ASSERT_EQ(show(link, "corridor.svg").status, 0);
  const std::set<std::string> texts = texts_in("corridor.svg");
  EXPECT_TRUE(texts.contains(
      "31.38 x 2.89 x 3.04 m, 19 objects, 5.18 GHz, 7 paths to depth 1, 4 within 6 dB are drawn"));
  EXPECT_TRUE(texts.contains("corridor"));  // the folder of its scene.xml
}

TEST_F(SceneShow, WritesPngByTheEnding) {
  ASSERT_EQ(show({kSite}, "room.png").status, 0);
  std::ostringstream bytes;
  bytes << std::ifstream(out("room.png"), std::ios::binary).rdbuf();
  EXPECT_EQ(bytes.str().substr(0, 8), "\x89PNG\r\n\x1a\n");
}

TEST_F(SceneShow, DrawsTheSamePictureEachTime) {
  const auto content = [&](const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(out(name)).rdbuf();
    return text.str();
  };
  const std::vector<std::string> arguments{kSite, "--tx", "0.5,0.2,1.2", "--view", "3d"};
  ASSERT_EQ(show(arguments, "a.svg").status, 0);
  ASSERT_EQ(show(arguments, "b.svg").status, 0);
  EXPECT_EQ(content("a.svg"), content("b.svg"));
}

TEST_F(SceneShow, ReportsThatNoPathExistsAndDrawsTheRoom) {
  const Finished finished = show({kSite, "--tx", "0,0,0.73"}, "room.svg");
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.err,
            "rayloc scene show: the transmitter is inside of object 'table'; no path\n");
  EXPECT_TRUE(texts_in("room.svg").contains("tx"));
}

TEST_F(SceneShow, WrongCallsExitWith64AndWriteNothing) {
  const Finished ending = show({kSite}, "room.pdf");
  EXPECT_EQ(ending.status, 64);
  EXPECT_EQ(ending.err,
            "rayloc: --out " + out("room.pdf") +
                ": pictures are .svg or .png; choose one by the ending\n");
  const Finished one_end = show({kCorridor, "--tx", "0,0,1"}, "a.svg");
  EXPECT_EQ(one_end.status, 64);
  EXPECT_NE(one_end.err.find("give both --tx and --rx"), std::string::npos) << one_end.err;
  EXPECT_EQ(show({kSite, "--view", "side"}, "a.svg").status, 64);
  EXPECT_EQ(show({kSite, "--tx", "0,0"}, "a.svg").status, 64);
  const Finished unknown = show({kSite, "--tx", "0,0,1", "--ap", "ap9"}, "a.svg");
  EXPECT_EQ(unknown.status, 64);
  EXPECT_NE(unknown.err.find("ap9"), std::string::npos) << unknown.err;
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SceneShow, FolderThatDoesNotExistIsMade) {
  ASSERT_EQ(show({kSite}, "new/room.svg").status, 0);
  EXPECT_TRUE(fs::exists(out("new/room.svg")));
}

TEST_F(SceneShow, HelpHasAnExample) {
  const Finished help = RaylocProcess({"scene", "show", "--help"}).wait();
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("Example:\n  rayloc scene show"), std::string::npos) << help.out;
}

}  // namespace
}  // namespace rayloc::scene_show_test
