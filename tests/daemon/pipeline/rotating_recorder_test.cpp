// Files one after the other, within limits, and a mark wherever something is missing.
#include "daemon/pipeline/record/rotating_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <memory>

#include "capture/record/recording_repair.h"
#include "capture/source/pcap_source.h"
#include "daemon/pipeline/record/recording_folder.h"
#include "tests/support/read_to_end.h"

namespace rayloc::rotating_recorder_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The content of a recording.
struct Recorded {
  std::vector<std::int64_t> times;  // microseconds
  std::uint64_t gaps = 0;
  std::uint64_t unrecorded = 0;
};

Recorded read_back(const fs::path& file) {
  Recorded all;
  const auto source = PcapFileSource::open(file.string()).value();
  test::read_to_end(*source, [&](const Datagram& datagram) {
    all.times.push_back(
        std::chrono::duration_cast<std::chrono::microseconds>(datagram.time.time_since_epoch())
            .count());
  });
  SourceCounters counters = source->counters();
  all.gaps = counters.rejected["gap_mark"];
  all.unrecorded = counters.unrecorded;
  return all;
}

// A separate folder, and a recorder whose time and disk space the test controls.
class Recordings {
 public:
  Recordings() { fs::remove_all(folder_); }
  virtual ~Recordings() { fs::remove_all(folder_); }
  Recordings(const Recordings&) = delete;
  Recordings& operator=(const Recordings&) = delete;

  std::unique_ptr<RotatingRecorder> open(const RecordingLimits& limits) {
    RotatingRecorderOptions options;
    options.folder = folder_;
    options.name = "ap1";
    options.limits = limits;
    options.now = [this] { return Timestamp(std::chrono::seconds(1'763'733'909) + passed_); };
    options.steady = [this] { return std::chrono::steady_clock::time_point(passed_); };
    options.free_bytes = [this] { return free_; };
    return std::make_unique<RotatingRecorder>(std::move(options));
  }

  // The next `count` datagrams, a microsecond apart.
  void write(RotatingRecorder& recorder, int count) {
    std::vector<Datagram> batch;
    batch.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      batch.push_back({Timestamp(std::chrono::microseconds(next_++)), {}, payload_});
    }
    recorder.write(batch);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      all.push_back(entry.path().filename().string());
    }
    std::sort(all.begin(), all.end());
    return all;
  }
  Recorded read(const std::string& name) const { return read_back(folder_ / name); }

  const fs::path folder_ =
      fs::temp_directory_path() / ("rotating_recorder." + std::to_string(getpid()));
  std::vector<std::byte> payload_ = std::vector<std::byte>(1000);
  std::chrono::seconds passed_{0};
  std::uint64_t free_ = std::uint64_t{1} << 40U;
  std::int64_t next_ = 0;
};

class RotatingRecorderTest : public ::testing::Test, protected Recordings {};

TEST_F(RotatingRecorderTest, NamesAFileWhenItIsClosed) {
  auto recorder = open({});
  write(*recorder, 3);
  EXPECT_THAT(names(), ElementsAre("ap1-20251121T140509Z.pcap.part"));
  recorder.reset();
  EXPECT_THAT(names(), ElementsAre("ap1-20251121T140509Z.pcap"));
  EXPECT_THAT(read("ap1-20251121T140509Z.pcap").times, ElementsAre(0, 1, 2));
}

TEST_F(RotatingRecorderTest, LeavesNoFileWithoutARecord) {
  open({}).reset();
  EXPECT_THAT(names(), ElementsAre());
}

TEST_F(RotatingRecorderTest, RotatesBySizeAndByAge) {
  auto recorder = open({.rotate_bytes = 2500, .rotate_every = std::chrono::seconds(10)});
  write(*recorder, 3);  // too long now
  write(*recorder, 1);  // into the second
  passed_ += std::chrono::seconds(9);
  write(*recorder, 1);
  passed_ += std::chrono::seconds(1);
  recorder->write({});  // old enough, although nothing comes
  passed_ += std::chrono::seconds(20);
  recorder->write({});  // the empty one stays
  EXPECT_THAT(names(),
              ElementsAre("ap1-20251121T140509Z-2.pcap",
                          "ap1-20251121T140509Z.pcap",
                          "ap1-20251121T140519Z.pcap.part"));
  EXPECT_THAT(read("ap1-20251121T140509Z.pcap").times, ElementsAre(0, 1, 2));
  EXPECT_THAT(read("ap1-20251121T140509Z-2.pcap").times, ElementsAre(3, 4));
  EXPECT_EQ(recorder->counters().files, 2U);
  EXPECT_EQ(recorder->counters().written, 5U);
  EXPECT_EQ(recorder->counters().bytes, 3U * 24 + 5 * (16 + 42 + 1000));
}

TEST_F(RotatingRecorderTest, ReportsAFailedRenaming) {
  auto recorder = open({.rotate_bytes = 2500});
  write(*recorder, 3);
  fs::create_directory(folder_ / "ap1-20251121T140509Z.pcap");  // of another program
  passed_ += std::chrono::seconds(1);
  write(*recorder, 1);  // into the second
  EXPECT_THAT(recorder->counters().error,
              HasSubstr("ap1-20251121T140509Z.pcap.part: cannot be renamed: Is a directory"));
  EXPECT_EQ(recorder->counters().files, 0U);
  EXPECT_EQ(recorder->counters().lost, 0U);
  EXPECT_THAT(read("ap1-20251121T140509Z.pcap.part").times, ElementsAre(0, 1, 2));
}

TEST_F(RotatingRecorderTest, KeepsTheTotalByRemovingTheOldest) {
  auto recorder = open({.rotate_bytes = 5000, .max_total_bytes = 20'000});
  for (int i = 0; i < 100; ++i) {
    passed_ += std::chrono::seconds(1);
    write(*recorder, 1);
  }
  std::uint64_t total = 0;
  for (const std::string& name : names()) {
    total += fs::file_size(folder_ / name);
  }
  EXPECT_LT(total, 20'000U + 5 * 1100);  // written between two checks
  EXPECT_GT(total, 14'000U);
  EXPECT_GT(recorder->counters().removed, 10U);
  EXPECT_EQ(read(names().back()).times.back(), 99) << "the newest are there";
}

TEST_F(RotatingRecorderTest, StopsWhenTheDiskIsNearlyFullAndMarksTheGap) {
  auto recorder = open({.min_free_bytes = 1'000'000});
  write(*recorder, 2);
  free_ = 999'999;
  write(*recorder, 1);  // the free space is checked once a second
  passed_ += std::chrono::seconds(1);
  write(*recorder, 40);
  EXPECT_TRUE(recorder->counters().stopped);
  EXPECT_THAT(recorder->counters().error, HasSubstr("until there is room"));
  free_ = 1'000'001;
  passed_ += std::chrono::seconds(1);
  write(*recorder, 2);
  EXPECT_TRUE(recorder->counters().stopped) << "barely enough would end at once";
  free_ = 2'000'000;
  passed_ += std::chrono::seconds(1);
  write(*recorder, 3);
  EXPECT_FALSE(recorder->counters().stopped);
  EXPECT_EQ(recorder->counters().error, "");
  const RotatingRecorderCounters counters = recorder->counters();
  EXPECT_EQ(counters.given, 48U);
  EXPECT_EQ(counters.written, 6U);
  EXPECT_EQ(counters.lost, 42U);
  EXPECT_EQ(counters.stops, 1U);
  EXPECT_EQ(counters.gaps, 1U);
  recorder.reset();
  const Recorded all = read("ap1-20251121T140509Z.pcap");
  EXPECT_THAT(all.times, ElementsAre(0, 1, 2, 45, 46, 47));
  EXPECT_EQ(all.gaps, 1U);
  EXPECT_EQ(all.unrecorded, 42U);
}

TEST_F(RotatingRecorderTest, BeginsStoppedOnAFullDiskAndGoesOnByItself) {
  free_ = 0;
  auto recorder = open({.min_free_bytes = 1'000'000});
  write(*recorder, 5);
  EXPECT_THAT(names(), ElementsAre());
  free_ = 2'000'000;
  passed_ += std::chrono::seconds(1);
  write(*recorder, 2);
  recorder.reset();
  const Recorded all = read("ap1-20251121T140510Z.pcap");
  EXPECT_THAT(all.times, ElementsAre(5, 6));
  EXPECT_EQ(all.unrecorded, 5U);
}

// A limit on the length of files acts as a disk that became full between two checks.
TEST_F(RotatingRecorderTest, MarksDatagramsThatTheDiskRefused) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit little{3000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  auto recorder = open({});
  setrlimit(RLIMIT_FSIZE, &before);  // its process keeps the limit
  write(*recorder, 2);
  write(*recorder, 3);
  EXPECT_THAT(recorder->counters().error, HasSubstr("cannot be written"));
  EXPECT_EQ(recorder->counters().lost, 3U);
  // The mark itself fits: it is written at the end.
  recorder.reset();
  const Recorded all = read("ap1-20251121T140509Z.pcap");
  EXPECT_THAT(all.times, ElementsAre(0, 1));
  EXPECT_EQ(all.gaps, 1U);
  EXPECT_EQ(all.unrecorded, 3U);
}

TEST_F(RotatingRecorderTest, MarksEachReasonInOrder) {
  auto recorder = open({});
  write(*recorder, 1);
  recorder->note_dropped(7,
                         "buffer_full",
                         Timestamp(std::chrono::microseconds(1)),
                         Timestamp(std::chrono::microseconds(1)));
  recorder->note_dropped(
      4, "other", Timestamp(std::chrono::microseconds(1)), Timestamp(std::chrono::microseconds(1)));
  write(*recorder, 1);
  EXPECT_EQ(recorder->counters().gaps, 2U);
  EXPECT_EQ(recorder->counters().lost, 0U) << "they were never given";
  recorder.reset();
  EXPECT_EQ(read("ap1-20251121T140509Z.pcap").unrecorded, 11U);
}

TEST_F(RotatingRecorderTest, ItsOpenFileIsNotRepaired) {
  auto recorder = open({.rotate_bytes = 100});
  write(*recorder, 1);
  write(*recorder, 1);  // rotated: the lock is of the file that is written now
  const std::string part = (folder_ / "ap1-20251121T140509Z-2.pcap.part").string();
  EXPECT_EQ(repair_recording(part, Timestamp{})->result, RecordingRepair::Result::kInUse);
}

// The recorder cannot begin until `mend`: the datagrams of two batches are lost, which is counted
// and reported, and recording begins a second later.
void expect_to_begin_after(Recordings& all,
                           const std::function<void()>& mend,
                           const std::string& message) {
  auto recorder = all.open({.min_free_bytes = 0});
  EXPECT_THAT(recorder->counters().error, HasSubstr(message)) << "before anything came";
  all.write(*recorder, 2);
  all.passed_ += std::chrono::seconds(1);
  all.write(*recorder, 3);
  EXPECT_THAT(recorder->counters().error, HasSubstr(message));
  EXPECT_EQ(recorder->counters().lost, 5U);
  mend();
  all.passed_ += std::chrono::seconds(1);
  recorder->write({});  // tried again although nothing comes
  EXPECT_EQ(recorder->counters().error, "");
  all.write(*recorder, 2);
  EXPECT_EQ(recorder->counters().given, 7U);
  EXPECT_EQ(recorder->counters().written, 2U);
  recorder.reset();
  const Recorded recorded = all.read("ap1-20251121T140511Z.pcap");
  EXPECT_THAT(recorded.times, ElementsAre(5, 6));
  EXPECT_EQ(recorded.gaps, 1U);
  EXPECT_EQ(recorded.unrecorded, 5U);
}

// As a disk without a free byte.
class NoRoomForFiles {
 public:
  NoRoomForFiles() {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit nothing{0, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &nothing);
  }
  ~NoRoomForFiles() { end(); }
  NoRoomForFiles(const NoRoomForFiles&) = delete;
  NoRoomForFiles& operator=(const NoRoomForFiles&) = delete;
  void end() const { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(Field, ARecorderWaitsForAFolderThatCannotBeMade) {
  Recordings all;
  std::ofstream(all.folder_) << "a file";
  expect_to_begin_after(
      all, [&] { fs::remove(all.folder_); }, "cannot be made: Not a directory");
}

TEST(Field, ARecorderWaitsForAFolderThatItMayWriteTo) {
  if (geteuid() == 0) {
    GTEST_SKIP() << "root may write everywhere; e2e_test has a read-only disk for it";
  }
  Recordings all;
  fs::create_directories(all.folder_);
  fs::permissions(all.folder_, fs::perms::owner_read | fs::perms::owner_exec);
  expect_to_begin_after(
      all,
      [&] { fs::permissions(all.folder_, fs::perms::owner_all); },
      "cannot be recorded to: Permission denied");
}

TEST(Field, ARecorderWaitsForRoomOnADiskThatIsFullAtTheStart) {
  Recordings all;
  const NoRoomForFiles full;
  expect_to_begin_after(
      all, [&] { full.end(); }, "cannot be written: File too large; make room on the disk");
}

TEST(Field, ARecorderLeavesNoFileBehindWhileItWaits) {
  Recordings all;
  const NoRoomForFiles full;
  auto recorder = all.open({.min_free_bytes = 0});
  all.passed_ += std::chrono::seconds(1);
  all.write(*recorder, 1);
  EXPECT_THAT(all.names(), ElementsAre());
}

TEST(Field, ARecorderMakesItsFolderAgainForTheNextFile) {
  Recordings all;
  auto recorder = all.open({.rotate_every = std::chrono::seconds(10)});
  all.write(*recorder, 1);
  fs::remove_all(all.folder_);
  all.passed_ += std::chrono::seconds(10);
  all.write(*recorder, 1);
  EXPECT_THAT(all.names(), ElementsAre("ap1-20251121T140519Z.pcap.part"));
}

}  // namespace
}  // namespace rayloc::rotating_recorder_test
