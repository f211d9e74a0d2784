#include "daemon/site/model/path_grid_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace rayloc::path_grid_files_test {
namespace {

namespace fs = std::filesystem;

class PathGridFilesTest : public ::testing::Test {
 public:
  ~PathGridFilesTest() override { fs::remove_all(folder_); }

 protected:
  PathGridFilesTest() {
    std::string name = (fs::temp_directory_path() / "rayloc-cache-XXXXXX").string();
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }

  PathGridFiles files(std::uint64_t most_bytes = 1'000'000) {
    PathGridFiles::Options options;
    options.directory = folder_ / "made" / "when needed";
    options.most_bytes = most_bytes;
    options.log = [this](const std::string& line) { log_.push_back(line); };
    return PathGridFiles(options);
  }
  fs::path file(const std::string& key) const {
    return folder_ / "made" / "when needed" / (key + ".pathgrid");
  }
  std::size_t count() const {
    const fs::directory_iterator all(file("").parent_path());
    return static_cast<std::size_t>(std::distance(fs::begin(all), fs::end(all)));
  }

  fs::path folder_;
  std::vector<std::string> log_;
};

TEST_F(PathGridFilesTest, ReadsBackSavedGrids) {
  const std::string bytes(10'000, 'x');
  files().save("one", bytes);
  EXPECT_EQ(files().load("one"), bytes);
  EXPECT_EQ(files().load("two"), std::nullopt);
  EXPECT_TRUE(log_.empty()) << log_.front();
  EXPECT_EQ(count(), 1U);  // nothing unfinished stays
}

TEST_F(PathGridFilesTest, OmitsAndReportsTruncatedDamagedAndForeignFiles) {
  const std::string bytes(1000, 'x');
  files().save("one", bytes);
  fs::resize_file(file("one"), 500);
  EXPECT_EQ(files().load("one"), std::nullopt);
  EXPECT_NE(log_.back().find("cut off"), std::string::npos) << log_.back();

  for (const std::streamoff place : {0, 9, 17, 100, 1023}) {
    files().save("one", bytes);
    std::fstream stream(file("one"), std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(place);
    stream.put('\x7f');
    stream.close();
    EXPECT_EQ(files().load("one"), std::nullopt) << place;
  }
  EXPECT_NE(log_.back().find("damaged"), std::string::npos) << log_.back();

  std::ofstream(file("one")) << "a shopping list";
  EXPECT_EQ(files().load("one"), std::nullopt);
  EXPECT_NE(log_.back().find("no path grid"), std::string::npos) << log_.back();
  EXPECT_NE(log_.back().find("one.pathgrid"), std::string::npos) << log_.back();
  EXPECT_EQ(log_.size(), 7U);

  files().save("one", bytes);
  EXPECT_EQ(files().load("one"), bytes);
}

TEST_F(PathGridFilesTest, DropsTheLeastRecentlyUsedFile) {
  const std::string bytes(1000, 'x');
  PathGridFiles three = files(3072);
  const auto now = fs::file_time_type::clock::now();
  for (const auto& [key, minutes] : {std::pair{"a", 30}, {"b", 20}, {"c", 10}}) {
    three.save(key, bytes);
    fs::last_write_time(file(key), now - std::chrono::minutes(minutes));
  }
  EXPECT_TRUE(three.load("a"));  // and so it is used now
  three.save("d", bytes);
  EXPECT_TRUE(fs::exists(file("a")));
  EXPECT_FALSE(fs::exists(file("b")));
  EXPECT_TRUE(fs::exists(file("c")));
  EXPECT_TRUE(fs::exists(file("d")));
}

TEST_F(PathGridFilesTest, KeepsNothingThatIsLargerThanItsBound) {
  files(1000).save("one", std::string(1000, 'x'));
  EXPECT_EQ(files().load("one"), std::nullopt);
  ASSERT_EQ(log_.size(), 1U);
  EXPECT_NE(log_[0].find("not kept"), std::string::npos);
}

TEST_F(PathGridFilesTest, RemovesUnfinishedFilesOfEndedPrograms) {
  files().save("one", "x");
  const fs::path left = file("").parent_path() / "two.pathgrid.123.unfinished";
  const fs::path fresh = file("").parent_path() / "two.pathgrid.124.unfinished";
  std::ofstream(left) << "half";
  std::ofstream(fresh) << "half";
  fs::last_write_time(left, fs::file_time_type::clock::now() - std::chrono::hours(2));
  files().save("one", "y");
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(fresh));
}

TEST_F(PathGridFilesTest, AFolderThatCannotBeMadeIsNoFailure) {
  std::ofstream(folder_ / "made") << "a file in the way";
  files().save("one", "x");
  EXPECT_EQ(files().load("one"), std::nullopt);
  ASSERT_EQ(log_.size(), 1U);
  EXPECT_NE(log_[0].find("not kept"), std::string::npos);
}

TEST(CacheDirectory, IsTheServicesThenTheUsers) {
  const auto with = [](const char* service, const char* xdg, const char* home) {
    const auto variables = std::to_array<std::pair<const char*, const char*>>(
        {{"CACHE_DIRECTORY", service}, {"XDG_CACHE_HOME", xdg}, {"HOME", home}});
    for (const auto& [name, value] : variables) {
      value == nullptr ? ::unsetenv(name) : ::setenv(name, value, 1);
    }
    return cache_directory();
  };
  EXPECT_EQ(with("/var/cache/raylocd:/other", "/x", "/home/me"), "/var/cache/raylocd");
  EXPECT_EQ(with(nullptr, "/x", "/home/me"), "/x/rayloc");
  EXPECT_EQ(with(nullptr, "relative", "/home/me"), "/home/me/.cache/rayloc");
  EXPECT_EQ(with(nullptr, "", "/home/me"), "/home/me/.cache/rayloc");
  EXPECT_EQ(with(nullptr, nullptr, nullptr), std::nullopt);
}

}  // namespace
}  // namespace rayloc::path_grid_files_test
