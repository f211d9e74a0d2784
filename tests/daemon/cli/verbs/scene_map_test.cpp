// `rayloc scene map` as a process of its own.
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::scene_map_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSite = test::data_path("/sites/meeting_room");
const std::string kCorridor = test::data_path("/scenes/corridor/scene.xml");

class SceneMap : public ::testing::Test {
 protected:
  SceneMap() { fs::create_directories(folder_); }
  ~SceneMap() override { fs::remove_all(folder_); }

  std::string out(const std::string& name) const { return folder_ / name; }
  Finished map(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"scene", "map"});
    return RaylocProcess(std::move(arguments)).wait();
  }

  const fs::path folder_ =
      fs::temp_directory_path() / ("rayloc-map-test." + std::to_string(::getpid()));
};

TEST_F(SceneMap, WritesPicturesAndArraysOfASite) {
  const Finished made = map({kSite, "--step", "0.25", "--depth", "2", "--out", out("map")});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("14 x 11 cells of 0.25 m at a height of 1.20 m"));
  EXPECT_THAT(made.out, HasSubstr("ap3"));
  for (const char* name : {"path-gain", "delay-spread", "paths", "strongest"}) {
    EXPECT_GT(fs::file_size(out("map/") + name + ".png"), 1000U) << name;
    pugi::xml_document document;
    ASSERT_TRUE(document.load_file((out("map/") + name + ".svg").c_str())) << name;
    const auto squares = document.child("svg").children("polygon");
    EXPECT_GE(std::distance(squares.begin(), squares.end()), 14 * 11) << name;
  }
  EXPECT_GT(fs::file_size(out("map/radio-map.npz")), 4000U);
  const Finished again = map({kSite, "--step", "0.25", "--out", out("map")});
  EXPECT_EQ(again.status, 64) << again.err;
}

TEST_F(SceneMap, ComparesProposedAntennas) {
  const Finished made = map({kCorridor,
                             "--antenna",
                             "-8,0,2.2",
                             "--antenna",
                             "8,0,2.2",
                             "--depth",
                             "1",
                             "--step",
                             "1",
                             "--out",
                             out("two")});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("antenna 1"));
  EXPECT_THAT(made.out, HasSubstr("antenna 2"));
  const Finished one =
      map({kSite, "--access-points", "ap2", "--depth", "0", "--step", "0.5", "--out", out("one")});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_THAT(one.out, Not(HasSubstr("ap1")));
  EXPECT_FALSE(fs::exists(out("one/strongest.png"))) << "of one there is no loudest";
}

TEST_F(SceneMap, ReportsMissingArguments) {
  const auto refused = [&](std::vector<std::string> arguments, int status, const char* words) {
    arguments.insert(arguments.end(), {"--out", out("none")});
    const Finished run = map(arguments);
    EXPECT_EQ(run.status, status) << run.err;
    EXPECT_THAT(run.err, HasSubstr(words));
    EXPECT_FALSE(fs::exists(out("none")));
  };
  refused({kCorridor}, 64, "has no access point: give --antenna X,Y,Z");
  refused({kCorridor, "--access-points", "ap1"}, 64, "is a scene, which has none");
  refused({kSite, "--access-points", "ap9"}, 64, "ap9");
  refused({kSite, "--antenna", "1,2"}, 64, "--antenna");
  refused({kSite, "--height", "9"}, 64, "the room reaches from");
  refused({kCorridor, "--antenna", "0,0,2", "--step", "0.001"}, 64, "--step");
}

}  // namespace
}  // namespace rayloc::scene_map_test
