// The reader and Wireshark can read all that the recorder writes, also after its process was killed
// or the disk was full.
#include "capture/record/pcap_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <random>

#include "capture/source/pcap_source.h"
#include "tests/support/pcap_files.h"
#include "tests/support/read_to_end.h"

namespace rayloc::pcap_recorder_test {
namespace {

using test::ByteString;
using ::testing::HasSubstr;

// A file that is gone with the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name) : path_(test::temporary_path(name)) {
    unlink(path_.c_str());
  }
  ~TemporaryFile() { unlink(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

struct Recorded {
  Timestamp time;
  DatagramAddress address;
  ByteString payload;

  friend bool operator==(const Recorded&, const Recorded&) = default;
};

Datagram as_datagram(const Recorded& recorded) {
  return {recorded.time, recorded.address, std::as_bytes(std::span(recorded.payload))};
}

// Datagrams of every length from 0 on and at odd times, seeded.
std::vector<Recorded> random_datagrams(std::size_t count) {
  std::mt19937 random(20261121);
  std::vector<Recorded> all;
  std::int64_t microseconds = 1525500671306626;
  for (std::size_t i = 0; i < count; ++i) {
    microseconds += static_cast<std::int64_t>(random() % 2000);
    Recorded one;
    one.time = Timestamp(std::chrono::microseconds(microseconds));
    one.address = {.source_ip = static_cast<std::uint32_t>(random()),
                   .destination_ip = static_cast<std::uint32_t>(random()),
                   .source_port = static_cast<std::uint16_t>(random()),
                   .destination_port = static_cast<std::uint16_t>(random())};
    for (std::size_t k = 0; k < i % 1500; ++k) {
      one.payload.push_back(static_cast<char>(random()));
    }
    all.push_back(one);
  }
  return all;
}

Expected<void> write(PcapRecorder& recorder, std::span<const Recorded> all) {
  std::vector<Datagram> batch;
  for (const Recorded& one : all) {
    batch.push_back(as_datagram(one));
  }
  return recorder.write(batch);
}

std::vector<Recorded> read_back(const std::string& path, Duration max_disorder = Duration(0)) {
  std::vector<Recorded> all;
  auto source = PcapFileSource::open(path, {.port = {}, .max_disorder = max_disorder});
  if (!source) {
    ADD_FAILURE() << source.error().message;
    return all;
  }
  test::read_to_end(**source, [&](const Datagram& d) {
    const auto* bytes = reinterpret_cast<const char*>(d.payload.data());
    all.push_back({d.time, d.address, ByteString(bytes, d.payload.size())});
  });
  EXPECT_EQ((*source)->counters().rejected, (std::map<std::string, std::uint64_t>{}));
  EXPECT_TRUE((*source)->warnings().empty());
  return all;
}

TEST(PcapRecorder, ReadsBackWrittenDatagrams) {
  const TemporaryFile file("roundtrip.pcap");
  const auto all = random_datagrams(1600);
  {
    auto recorder = PcapRecorder::create(file.path());
    ASSERT_TRUE(recorder) << recorder.error().message;
    ASSERT_TRUE(write(*recorder, std::span(all).first(1)));
    ASSERT_TRUE(write(*recorder, std::span(all).subspan(1)));
    EXPECT_EQ(recorder->counters().given, all.size());
    EXPECT_EQ(recorder->counters().delivered, all.size());
    EXPECT_EQ(recorder->counters().bytes, test::read_file(file.path()).size());
  }
  EXPECT_EQ(read_back(file.path()), all);
}

TEST(PcapRecorder, TruncatesTimesToMicroseconds) {
  const TemporaryFile file("microseconds.pcap");
  Recorded one;
  one.time = Timestamp(Duration(1'999'999'999));
  {
    auto recorder = PcapRecorder::create(file.path());
    ASSERT_TRUE(recorder && write(*recorder, {&one, 1}));
  }
  const auto back = read_back(file.path());
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0].time, Timestamp(Duration(1'999'999'000)));
}

// The bytes of one record by hand: what other programs rely on.
TEST(PcapRecorder, MakesUpTheHeadersOfTheAccessPoint) {
  const TemporaryFile file("headers.pcap");
  const Recorded one{Timestamp(std::chrono::microseconds(1525500671306626)), {}, "csi"};
  {
    auto recorder = PcapRecorder::create(file.path());
    ASSERT_TRUE(recorder && write(*recorder, {&one, 1}));
  }
  const auto little = test::Endian::kLittle;
  // IPv4 checksum: ~(4500+001f+0000+4000+4011+0a0a+0a0a+ffff+ffff) = 26bb.
  // UDP checksum: ~(0a0a+0a0a+ffff+ffff+0011+000b + 157c+157c+000b+0000 + 6373+6900) = f458.
  const ByteString packet = ByteString(
                                "\xff\xff\xff\xff\xff\xff"
                                "NEXMON"
                                "\x08\x00",
                                14) +
                            ByteString("\x45\x00\x00\x1f\x00\x00\x40\x00\x40\x11\x26\xbb", 12) +
                            ByteString("\x0a\x0a\x0a\x0a\xff\xff\xff\xff", 8) +
                            ByteString("\x15\x7c\x15\x7c\x00\x0b\xf4\x58", 8) + "csi";
  const ByteString expected =
      test::pcap_header(little, false) + test::pcap_record(little, 1525500671, 306626, packet);
  EXPECT_EQ(test::read_file(file.path()), expected);
}

TEST(PcapRecorder, NeverOverwritesAFile) {
  const TemporaryFile file("exists.pcap");
  test::write_file(file.path(), "precious");
  const auto recorder = PcapRecorder::create(file.path());
  ASSERT_FALSE(recorder);
  EXPECT_EQ(recorder.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(recorder.error().message, HasSubstr(file.path()));
  EXPECT_THAT(recorder.error().message, HasSubstr("does not exist yet"));
  EXPECT_EQ(test::read_file(file.path()), "precious");
}

TEST(PcapRecorder, RefusesABatchWithATimeThatThePcapCannotHold) {
  const TemporaryFile file("before1970.pcap");
  auto all = random_datagrams(3);
  all[1].time = Timestamp(std::chrono::seconds(-1));
  auto recorder = PcapRecorder::create(file.path());
  ASSERT_TRUE(recorder);
  EXPECT_FALSE(write(*recorder, all));
  EXPECT_TRUE(write(*recorder, std::span(all).first(1)));
  EXPECT_EQ(recorder->counters().given, 4U);
  EXPECT_EQ(recorder->counters().lost(), 3U);
  EXPECT_EQ(recorder->counters().delivered, 1U);
  EXPECT_EQ(read_back(file.path()).size(), 1U);
}

// A limit on the length of files, which processes inherit: as a disk that is nearly full.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::uint64_t bytes) {
    EXPECT_EQ(getrlimit(RLIMIT_FSIZE, &before_), 0);
    const rlimit limit{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

// The append that crosses the limit takes only a part; in the larger batch it is not the first.
TEST(PcapRecorder, CutsOffThePartOfABatchThatAFullDiskTook) {
  const auto all = random_datagrams(1200);
  std::uint64_t whole = 0;
  {
    const TemporaryFile file("measured.pcap");
    auto recorder = PcapRecorder::create(file.path());
    ASSERT_TRUE(recorder && write(*recorder, std::span(all).first(50)));
    whole = recorder->counters().bytes;
  }
  for (const std::size_t lost : {10U, 1150U}) {
    const TemporaryFile file("full.pcap");
    const FileSizeLimit limit(whole + (lost == 10 ? 500 : 200'000));
    auto recorder = PcapRecorder::create(file.path());
    ASSERT_TRUE(recorder && write(*recorder, std::span(all).first(50)));
    const auto failed = write(*recorder, std::span(all).subspan(50, lost));
    ASSERT_FALSE(failed);
    EXPECT_THAT(failed.error().message, HasSubstr(file.path()));
    EXPECT_EQ(recorder->counters().lost(), lost);
    EXPECT_EQ(recorder->counters().errors, 1U);
    EXPECT_EQ(test::read_file(file.path()).size(), whole);
    // A smaller batch that fits is still recorded.
    ASSERT_TRUE(write(*recorder, std::span(all).first(1)));
    EXPECT_EQ(recorder->counters().given, recorder->counters().delivered + lost);
    EXPECT_EQ(read_back(file.path(), kAnyDisorder).size(), 51U);
  }
}

// Makes this process the parent of what a killed child leaves behind, so that it can wait for it.
class AdoptOrphans {
 public:
  AdoptOrphans() { prctl(PR_SET_CHILD_SUBREAPER, 1); }
  ~AdoptOrphans() { prctl(PR_SET_CHILD_SUBREAPER, 0); }
  AdoptOrphans(const AdoptOrphans&) = delete;
  AdoptOrphans& operator=(const AdoptOrphans&) = delete;
};

off_t size_of(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? status.st_size : 0;
}

// Writes as fast as it can and is killed some microseconds after the file holds that many bytes:
// how long that takes is the machine's affair.
void record_and_kill(const std::string& path,
                     std::span<const Recorded> all,
                     off_t bytes,
                     unsigned after) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto recorder = PcapRecorder::create(path);
    while (recorder && write(*recorder, all)) {
    }
    _exit(1);
  }
  int status = 0;
  while (size_of(path) < bytes) {
    ASSERT_EQ(waitpid(child, &status, WNOHANG), 0) << "it ended by itself with " << status;
    usleep(10);
  }
  usleep(after);
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself with " << status;
  while (waitpid(-1, nullptr, 0) > 0) {  // its writer
  }
}

// A killed recorder's file: whole records only, and each what was written. Each batch spans many
// pages: with write(2) in the killed process itself, one kill in seven leaves a torn record.
TEST(PcapRecorder, LeavesWholeRecordsWhenKilled) {
  const AdoptOrphans adopt;
  const auto all = random_datagrams(150);
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const TemporaryFile file("killed.pcap");
    const auto bytes = static_cast<off_t>(1 + random() % 100'000);
    ASSERT_NO_FATAL_FAILURE(
        record_and_kill(file.path(), all, bytes, static_cast<unsigned>(random() % 500)));
    const auto back = read_back(file.path(), kAnyDisorder);
    for (std::size_t i = 0; i < back.size(); ++i) {
      ASSERT_EQ(back[i], all[i % all.size()]) << "record " << i << " of round " << round;
    }
  }
}

}  // namespace
}  // namespace rayloc::pcap_recorder_test
