// Which files are recordings, how old they are by their names, and which go first.
#include "daemon/pipeline/record/recording_folder.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>

namespace rayloc::recording_folder_test {
namespace {

namespace fs = std::filesystem;

class RecordingFolderTest : public ::testing::Test {
 protected:
  RecordingFolderTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void make(const std::string& name, std::size_t bytes) const {
    std::ofstream(folder_ / name) << std::string(bytes, 'x');
  }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      all.insert(entry.path().filename().string());
    }
    return all;
  }

  const fs::path folder_ =
      fs::temp_directory_path() / ("recording_folder." + std::to_string(getpid()));
};

TEST_F(RecordingFolderTest, RecognisesItsOwnFileNames) {
  EXPECT_EQ(recording_age_key("/a/ap1-20261121T140509Z.pcap"), "20261121T140509Z");
  EXPECT_EQ(recording_age_key("my-ap-20261121T140509Z-12.pcap.part"), "20261121T140509Z-12");
  for (const char* const name : {"ap1.pcap",
                                 "-20261121T140509Z.pcap",
                                 "20261121T140509Z.pcap",
                                 "ap1-20261121T140509Z.pcap.gz",
                                 "ap1-20261121T140509Z.csv",
                                 "ap1-20261121T140509Z-.pcap",
                                 "ap1-20261121T140509Z-copy.pcap",
                                 "ap1-2026112aT140509Z.pcap",
                                 ".part",
                                 ""}) {
    EXPECT_EQ(recording_age_key(name), "") << name;
  }
}

TEST_F(RecordingFolderTest, GivesAnUnusedName) {
  const Timestamp time(std::chrono::seconds(1'763'733'909));
  EXPECT_EQ(free_recording_name(folder_, "ap1", time).filename(), "ap1-20251121T140509Z.pcap");
  make("ap1-20251121T140509Z.pcap", 1);
  make("ap1-20251121T140509Z-2.pcap.part", 1);
  EXPECT_EQ(free_recording_name(folder_, "ap1", time).filename(), "ap1-20251121T140509Z-3.pcap");
  EXPECT_EQ(free_recording_name(folder_, "ap2", time).filename(), "ap2-20251121T140509Z.pcap");
}

TEST_F(RecordingFolderTest, ListsRecentRecordingsOfAnAccessPoint) {
  const auto now = std::filesystem::file_time_type::clock::now();
  for (const char* const name : {"ap1-20251121T140509Z.pcap.part",
                                 "ap1-20251121T130509Z-2.pcap",
                                 "ap1-20251121T130509Z.pcap",
                                 "ap1-20251121T120509Z.pcap",
                                 "ap1-ring-20251121T140509Z.pcap",
                                 "ap11-20251121T140509Z.pcap"}) {
    make(name, 1);
  }
  std::filesystem::last_write_time(folder_ / "ap1-20251121T120509Z.pcap",
                                   now - std::chrono::hours(2));
  std::string found;
  for (const auto& file :
       recordings_since(folder_, "ap1", std::chrono::system_clock::now() - std::chrono::hours(1))) {
    found += file.filename().string() + " ";
  }
  EXPECT_EQ(
      found,
      "ap1-20251121T130509Z.pcap ap1-20251121T130509Z-2.pcap ap1-20251121T140509Z.pcap.part ");
}

TEST_F(RecordingFolderTest, RemovesTheOldestUntilTheRestFits) {
  make("ap1-20260101T000000Z.pcap", 100);
  make("ap2-20250101T000000Z-10.pcap", 100);
  make("ap2-20250101T000000Z-9.pcap", 100);
  make("ap1-20240101T000000Z.pcap.part", 100);  // being written
  make("ap3-20270101T000000Z.pcap", 100);
  make("precious.pcap", 1000);  // not ours
  EXPECT_EQ(remove_oldest_recordings(folder_, 500), 0U);
  EXPECT_EQ(remove_oldest_recordings(folder_, 499), 1U);
  EXPECT_EQ(names().count("ap2-20250101T000000Z-9.pcap"), 0U);
  EXPECT_EQ(remove_oldest_recordings(folder_, 250), 2U);
  EXPECT_EQ(names(),
            (std::set<std::string>{
                "ap1-20240101T000000Z.pcap.part", "ap3-20270101T000000Z.pcap", "precious.pcap"}));
  EXPECT_EQ(remove_oldest_recordings(folder_, 1), 1U);
  EXPECT_EQ(names(), (std::set<std::string>{"ap1-20240101T000000Z.pcap.part", "precious.pcap"}));
  EXPECT_EQ(remove_oldest_recordings(folder_ / "missing", 1), 0U);
}

}  // namespace
}  // namespace rayloc::recording_folder_test
