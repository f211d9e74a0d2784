// Tables of gains: read where site.toml names them, and taken along when a site is copied.
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/model/site_copy.h"
#include "tests/daemon/site/model/site_text.h"

namespace rayloc::site_pattern_test {
namespace {

namespace fs = std::filesystem;
using testing::edited_text;
using ::testing::HasSubstr;
using testing::kSiteFile;
using testing::kSiteText;
using ::testing::StartsWith;

constexpr const char* kBeam = "t,0,90,180,270\n0,1,1,1,1\n90,7,-1,-9,-1\n180,1,1,1,1\n";
constexpr const char* kOther = "t,0,90,180,270\n0,1,1,1,1\n90,5,-1,-9,-1\n180,1,1,1,1\n";

// A site in a folder of its own, whose access point has a table.
class SitePattern : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("site_pattern_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "antennas");
    fs::copy(kSiteFile.parent_path() / "scene.xml", folder_);
    fs::copy(kSiteFile.parent_path() / "meshes", folder_ / "meshes");
    write("antennas/beam.csv", kBeam);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const fs::path& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  // site.toml with another line for the access point's pattern, and one for the device's.
  Expected<Site> site(const std::string& pattern, const std::string& device = "") const {
    const std::string text =
        edited_text(std::string(kSiteText), "pattern = \"half_wave_dipole\"\n", pattern);
    write("site.toml", edited_text(text, "height_m = 1.1\n", "height_m = 1.1\n" + device));
    return load_site(folder_);
  }
  std::string errors(const std::string& pattern) const {
    const Expected<Site> result = site(pattern);
    return result ? "" : testing::without_folder(result.error().message, folder_ / "site.toml");
  }

  fs::path folder_;
};

double front_gain(const AntennaPattern& pattern) {
  return pattern.table().at(std::numbers::pi / 2, 0.0).dbi;
}

TEST_F(SitePattern, ATableIsReadFromTheFolderOfTheSite) {
  const Expected<Site> read = site("pattern_file = \"antennas/beam.csv\"\n");
  ASSERT_TRUE(read) << read.error().message;
  const AntennaPattern& pattern = read->access_points.at(0).array.pattern;
  ASSERT_EQ(pattern.kind(), AntennaPattern::kTable);
  EXPECT_NEAR(front_gain(pattern), 7.0, 1e-12);
  EXPECT_EQ(read->transmitters.at(0).pattern, AntennaPattern(AntennaPattern::kHalfWaveDipole));
}

TEST_F(SitePattern, NamesOfPatternsAreRead) {
  for (const std::string_view name : kAntennaPatternNames) {
    const Expected<Site> read = site("pattern = \"" + std::string(name) + "\"\n");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(to_string(read->access_points.at(0).array.pattern), name);
  }
}

TEST_F(SitePattern, ErrorsNameThePlaceInTheSiteAndInTheTable) {
  EXPECT_THAT(errors("pattern_file = \"antennas/bean.csv\"\n"),
              AllOf(StartsWith("site.toml:21:16: 'pattern_file': no file "),
                    HasSubstr("antennas/bean.csv; paths are relative")));
  EXPECT_THAT(errors("pattern_file = \"antennas\"\n"),
              StartsWith("site.toml:21:16: 'pattern_file': no file "));
  EXPECT_THAT(errors("pattern = \"dipole\"\npattern_file = \"antennas/beam.csv\"\n"),
              StartsWith("site.toml:22:16: 'pattern' is stated as well; keep one"));
  write("antennas/beam.csv", "t,0,90,180,270\n0,1,2,three,4\n90,1,2,3,4\n180,1,2,3,4\n");
  EXPECT_THAT(errors("pattern_file = \"antennas/beam.csv\"\n"),
              AllOf(StartsWith("site.toml:21:16: 'pattern_file': "),
                    HasSubstr("antennas/beam.csv:2: cell 4 is \"three\"; write a number")));
}

TEST_F(SitePattern, ACopyOfTheSiteHasItsTables) {
  write("antennas/other.csv", kOther);
  const Expected<Site> original =
      site("pattern_file = \"antennas/beam.csv\"\n",
           "pattern_file = \"" + (folder_ / "antennas" / "other.csv").string() + "\"\n");
  ASSERT_TRUE(original) << original.error().message;
  const fs::path copy = folder_ / "copy";
  const Expected<void> written = write_site(*original, "", copy);
  ASSERT_TRUE(written) << written.error().message;
  fs::remove_all(folder_ / "antennas");
  const Expected<Site> read = load_site(copy);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_NEAR(front_gain(read->access_points.at(0).array.pattern), 7.0, 1e-12);
  EXPECT_NEAR(front_gain(read->transmitters.at(0).pattern), 5.0, 1e-12);
  EXPECT_EQ(read->transmitters.at(1).pattern, original->transmitters.at(1).pattern);
}

}  // namespace
}  // namespace rayloc::site_pattern_test
