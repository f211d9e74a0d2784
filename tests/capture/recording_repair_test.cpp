// The repair of a killed recorder's file keeps every whole record, for a cut at any byte.
#include "capture/record/recording_repair.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>

#include "capture/record/pcap_format.h"
#include "capture/source/pcap_source.h"
#include "tests/support/pcap_files.h"
#include "tests/support/read_to_end.h"

namespace rayloc::recording_repair_test {
namespace {

using test::ByteString;

constexpr std::size_t kRecords = 6;
const Timestamp kNow{std::chrono::seconds(2000)};

class RecordingRepairTest : public ::testing::Test {
 protected:
  RecordingRepairTest() {
    std::vector<std::byte> bytes = pcap_file_header();
    ends_.push_back(bytes.size());
    for (std::size_t i = 0; i < kRecords; ++i) {
      const std::string payload(i * 7, static_cast<char>('a' + i));
      EXPECT_TRUE(
          append_pcap_record({Timestamp(std::chrono::milliseconds(1'000'000 + static_cast<int>(i))),
                              {},
                              std::as_bytes(std::span(payload))},
                             bytes));
      ends_.push_back(bytes.size());
    }
    whole_ = ByteString(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  void TearDown() override {
    unlink(path_.c_str());
    unlink(part_.c_str());
  }

  // The number of datagrams in the repaired file.
  std::size_t datagrams() {
    const auto source = PcapFileSource::open(path_).value();
    std::size_t count = 0;
    test::read_to_end(*source, [&](const Datagram&) { ++count; });
    EXPECT_TRUE(source->warnings().empty());
    EXPECT_EQ(source->counters().rejected, (std::map<std::string, std::uint64_t>{{"gap_mark", 1}}));
    return count;
  }

  const std::string path_ = test::temporary_path("repair.pcap");
  const std::string part_ = path_ + kPartSuffix;
  std::vector<std::size_t> ends_;  // of the header, and of each record
  ByteString whole_;
};

TEST_F(RecordingRepairTest, KeepsEveryWholeRecordWhereverTheFileIsCut) {
  for (std::size_t cut = 0; cut <= whole_.size(); ++cut) {
    std::size_t records = 0;
    while (records < kRecords && ends_[records + 1] <= cut) {
      ++records;
    }
    unlink(path_.c_str());
    test::write_file(part_, whole_.substr(0, cut));
    const auto repair = repair_recording(part_, kNow);
    ASSERT_TRUE(repair) << repair.error().message;
    EXPECT_EQ(repair->records, records) << "cut at " << cut;
    EXPECT_FALSE(std::filesystem::exists(part_));
    if (records == 0) {
      EXPECT_EQ(repair->result, RecordingRepair::Result::kEmpty);
      EXPECT_FALSE(std::filesystem::exists(path_));
      continue;
    }
    EXPECT_EQ(repair->result, RecordingRepair::Result::kRepaired);
    EXPECT_EQ(repair->cut_bytes, cut - ends_[records]);
    EXPECT_EQ(test::read_file(path_).substr(0, ends_[records]), whole_.substr(0, ends_[records]));
    EXPECT_EQ(datagrams(), records);
  }
}

// After a power failure a file may be as long as it was and hold zeros at its end.
TEST_F(RecordingRepairTest, CutsOffZerosAndGarbage) {
  for (const ByteString& garbage : {ByteString(100, '\0'), ByteString(100, '\xff')}) {
    unlink(path_.c_str());
    test::write_file(part_, whole_ + garbage);
    const auto repair = repair_recording(part_, kNow);
    ASSERT_TRUE(repair) << repair.error().message;
    EXPECT_EQ(repair->records, kRecords);
    EXPECT_EQ(repair->cut_bytes, 100U);
    EXPECT_EQ(datagrams(), kRecords);
  }
}

TEST_F(RecordingRepairTest, ReadsFilesLongerThanItsBuffer) {
  ByteString many = whole_.substr(0, ends_[0]);
  for (int i = 0; i < 5000; ++i) {
    many += whole_.substr(ends_[0]);
  }
  test::write_file(part_, many + "x");
  const auto repair = repair_recording(part_, kNow);
  ASSERT_TRUE(repair) << repair.error().message;
  EXPECT_EQ(repair->records, 5000 * kRecords);
  EXPECT_EQ(repair->cut_bytes, 1U);
  EXPECT_EQ(test::read_file(path_).substr(0, many.size()), many);
}

TEST_F(RecordingRepairTest, LeavesFilesInUseUnchanged) {
  test::write_file(part_, whole_);
  const int fd = open(part_.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(fd, LOCK_EX), 0);
  const auto repair = repair_recording(part_, kNow);
  ASSERT_TRUE(repair) << repair.error().message;
  EXPECT_EQ(repair->result, RecordingRepair::Result::kInUse);
  EXPECT_EQ(test::read_file(part_), whole_);
  close(fd);
}

}  // namespace
}  // namespace rayloc::recording_repair_test
