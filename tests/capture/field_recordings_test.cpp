// Recordings as they come from the field: damaged time stamps, clocks that were set, several files
// of one access point, captures in monitor mode.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>
#include <random>

#include "capture/source/event_clock.h"
#include "capture/source/recorded_source.h"
#include "tests/support/pcap_files.h"

namespace rayloc::field_recordings_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::ByteString;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr auto kLittle = test::Endian::kLittle;
constexpr std::int64_t kStart = 1'718'001'352'000'000;  // [us]
constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kHour = 3600 * kSecond;

Timestamp at(std::int64_t us) { return Timestamp(std::chrono::microseconds(us)); }

// Frames of three datagrams 10 us apart, each 100 ms, as a device that walks sends them.
std::vector<std::int64_t> walk(int frames, std::int64_t from = kStart) {
  std::vector<std::int64_t> stamps;
  for (int frame = 0; frame < frames; ++frame) {
    for (int rx_chain = 0; rx_chain < 3; ++rx_chain) {
      stamps.push_back(from + frame * (kSecond / 10) + rx_chain * std::int64_t{10});
    }
  }
  return stamps;
}

ByteString file_of(const std::vector<std::int64_t>& stamps, const std::string& prefix = "p") {
  ByteString file = test::pcap_header(kLittle, false);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    file += test::pcap_record(kLittle,
                              static_cast<std::uint32_t>(stamps[i] / kSecond),
                              static_cast<std::uint32_t>(stamps[i] % kSecond),
                              test::ethernet(test::ipv4({.payload = prefix + std::to_string(i)})));
  }
  return file;
}

struct Given {
  std::vector<Timestamp> times;
  std::vector<std::string> payloads;
  SourceCounters counters;
  std::vector<std::string> words;
  std::string error;
};

Given read_all(DatagramSource& source) {
  Given given;
  DatagramBatch batch;
  Timestamp watermark = Timestamp::min();
  while (!batch.ended) {
    if (auto read = source.read(batch, seconds(1)); !read) {
      given.error = read.error().message;
      break;
    }
    for (const Datagram& datagram : batch.datagrams) {
      EXPECT_GE(datagram.time, watermark);
      given.times.push_back(datagram.time);
      given.payloads.emplace_back(reinterpret_cast<const char*>(datagram.payload.data()),
                                  datagram.payload.size());
    }
    EXPECT_GE(batch.watermark, watermark);
    watermark = batch.watermark;
  }
  given.counters = source.counters();
  EXPECT_EQ(given.counters.delivered, given.times.size());
  EXPECT_EQ(given.counters.received,
            std::accumulate(given.counters.rejected.begin(),
                            given.counters.rejected.end(),
                            given.counters.delivered,
                            [](auto sum, const auto& one) { return sum + one.second; }));
  return given;
}

class Folder {
 public:
  Folder() : path_(test::temporary_path("field_recordings")) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directory(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string write(const std::string& name, const ByteString& bytes) const {
    std::string path = path_ + "/" + name;
    test::write_file(path, bytes);
    return path;
  }

 private:
  std::string path_;
};

Given read_files(const std::vector<std::string>& files, const PcapFileOptions& options = {}) {
  auto source = RecordedSource::open(files, options);
  if (!source) {
    Given given;
    given.error = source.error().message;
    return given;
  }
  Given given = read_all(**source);
  given.words = describe((*source)->plan());
  const auto warnings = (*source)->warnings();
  given.words.insert(given.words.end(), warnings.begin(), warnings.end());
  return given;
}

Given read_stamps(const std::vector<std::int64_t>& stamps, const PcapFileOptions& options = {}) {
  const Folder folder;
  return read_files({folder.write("walk.pcap", file_of(stamps))}, options);
}

// Reads the file from a pipe, as `cat walk.pcap | rayloc ...` does.
Given read_piped(const ByteString& file) {
  const Folder folder;
  const std::string path = folder.write("pipe", file);
  std::FILE* const pipe = popen(("cat " + path).c_str(), "r");
  auto source = RecordedSource::open({"/dev/fd/" + std::to_string(fileno(pipe))});
  Given given = read_all(**source);
  given.words = (*source)->warnings();
  pclose(pipe);
  return given;
}

using Counts = std::map<std::string, std::uint64_t>;

TEST(Field, OneDamagedStampAffectsOnlyItsOwnRecord) {
  for (const std::int64_t error : {kHour, 65536 * kSecond, -kHour, 11 * kSecond, -kSecond}) {
    for (const std::size_t where : {1U, 16U, 17U, 18U, 175U}) {
      std::vector<std::int64_t> stamps = walk(60);
      const auto even = stamps;
      stamps[where] += error;
      // At the end a gap of some seconds cannot be distinguished from a wrong stamp.
      if (where >= 175 && error > 0) {
        continue;
      }
      const Counts one = {{error > 0 ? "damaged_time" : "time_went_back", 1}};
      for (const Given& given : {read_stamps(stamps), read_piped(file_of(stamps))}) {
        EXPECT_EQ(given.counters.rejected, one) << error << " at " << where;
        ASSERT_EQ(given.times.size(), 179U) << error << " at " << where;
        for (std::size_t i = 0; i < given.times.size(); ++i) {
          ASSERT_EQ(given.times[i], at(even[i < where ? i : i + 1])) << error << " at " << where;
        }
      }
    }
  }
}

// As in a survey: the stamp of the last record before a pause, or of the first one behind it.
TEST(Field, ADamagedStampBesideAPauseAffectsNoOtherRecord) {
  for (const std::int64_t error : {kHour, -kHour}) {
    for (const std::size_t where : {14U, 15U}) {
      std::vector<std::int64_t> stamps = walk(5);
      const auto later = walk(5, kStart + 11 * kSecond);
      stamps.insert(stamps.end(), later.begin(), later.end());
      const auto even = stamps;
      stamps[where] += error;
      for (const Given& given : {read_stamps(stamps), read_piped(file_of(stamps))}) {
        EXPECT_EQ(given.counters.rejected,
                  (Counts{{error > 0 ? "damaged_time" : "time_went_back", 1}}))
            << error << " at " << where;
        ASSERT_EQ(given.times.size(), 29U);
        for (std::size_t i = 0; i < given.times.size(); ++i) {
          ASSERT_EQ(given.times[i], at(even[i < where ? i : i + 1])) << error << " at " << where;
        }
      }
    }
  }
}

TEST(Field, ReportsAClockThatWasNeverSet) {
  const Given given = read_stamps(walk(10, 15 * kSecond));
  EXPECT_EQ(given.times.size(), 30U);
  ASSERT_EQ(given.words.size(), 1U);
  EXPECT_THAT(given.words[0], HasSubstr("of the year 1970"));
}

// With a pause soon behind it that is longer than the step.
TEST(Field, AClockThatWasSetBackBeforeAPauseLosesNothing) {
  std::vector<std::int64_t> stamps = walk(20);
  const auto point = walk(5, kStart - 3 * kSecond);
  stamps.insert(stamps.end(), point.begin(), point.end());
  const auto later = walk(20, kStart + 9 * kSecond);
  stamps.insert(stamps.end(), later.begin(), later.end());
  const Given given = read_stamps(stamps);
  EXPECT_THAT(given.counters.rejected, IsEmpty());
  EXPECT_EQ(given.times.size(), stamps.size());
  EXPECT_TRUE(std::is_sorted(given.times.begin(), given.times.end()));
}

TEST(Field, ReportsADamagedStampWithItsPosition) {
  std::vector<std::int64_t> stamps = walk(60);
  stamps[17] += kHour;
  const Given given = read_stamps(stamps);
  ASSERT_EQ(given.words.size(), 1U);
  EXPECT_THAT(given.words[0], HasSubstr("walk.pcap: packet 18 (byte "));
  EXPECT_THAT(given.words[0], HasSubstr("3600.0 s ahead"));
  EXPECT_THAT(given.words[0], HasSubstr("damaged_time"));
}

TEST(Field, DamagedStampsOfAWholeFrameAreLeftOut) {
  std::vector<std::int64_t> stamps = walk(60);
  for (std::size_t i = 30; i < 36; ++i) {
    stamps[i] += 50 * kHour + static_cast<std::int64_t>(i) * kHour;
  }
  const Given given = read_stamps(stamps);
  EXPECT_EQ(given.counters.rejected, (Counts{{"damaged_time", 6}}));
}

TEST(Field, ADamagedFirstStampMovesNothing) {
  for (const std::int64_t first : {std::int64_t{0}, kStart + kHour}) {
    std::vector<std::int64_t> stamps = walk(20);
    stamps[0] = first;
    const Given given = read_stamps(stamps);
    ASSERT_EQ(given.times.size(), 59U);
    EXPECT_EQ(given.times.front(), at(kStart + 10));
    EXPECT_EQ(given.times.back(), at(walk(20).back()));
  }
}

TEST(Field, AClockThatWasSetBackLosesNothingAndGoesOnEvenly) {
  std::vector<std::int64_t> stamps = walk(40);
  const auto even = stamps;
  for (std::size_t i = 0; i < 60; ++i) {
    stamps[i] += kHour;
  }
  const Given given = read_stamps(stamps);
  EXPECT_THAT(given.counters.rejected, IsEmpty());
  ASSERT_EQ(given.times.size(), 120U);
  EXPECT_TRUE(std::is_sorted(given.times.begin(), given.times.end()));
  for (std::size_t i = 0; i < 120; ++i) {
    // By the clock as it was at the end; what passed at the step is known to some milliseconds.
    const Duration off = given.times[i] - at(even[i]);
    ASSERT_LT(i < 60 ? std::chrono::abs(off) : off, i < 60 ? milliseconds(100) : Duration(1)) << i;
  }
  ASSERT_EQ(given.words.size(), 1U);
  EXPECT_THAT(given.words[0], HasSubstr("packet 61 (byte "));
  EXPECT_THAT(given.words[0], HasSubstr("the clock was set back by 3599.9 s"));
}

TEST(Field, AClockSetForwardLosesNothingAndIsReportedOnce) {
  for (const std::int64_t by : {24 * kHour, 24 * kHour * 365 * 6}) {
    std::vector<std::int64_t> stamps = walk(40);
    for (std::size_t i = 60; i < stamps.size(); ++i) {
      stamps[i] += by;
    }
    for (const Given& given : {read_stamps(stamps), read_piped(file_of(stamps))}) {
      EXPECT_THAT(given.counters.rejected, IsEmpty());
      ASSERT_EQ(given.times.size(), 120U);
      EXPECT_EQ(given.times.back(), at(stamps.back()));
    }
    const Given given = read_stamps(stamps);
    ASSERT_EQ(given.words.size(), 1U);
    EXPECT_THAT(given.words[0], HasSubstr("packet 61 (byte "));
    EXPECT_THAT(given.words[0], HasSubstr("the clock was set, or nothing was received"));
  }
}

// Forward by an hour for four seconds, and back: it was set both times.
TEST(Field, AClockThatWasSetAndSetRightAgainGoesOnEvenly) {
  for (const std::int64_t by : {kHour, -kHour}) {
    std::vector<std::int64_t> stamps = walk(120);
    for (std::size_t i = 120; i < 240; ++i) {
      stamps[i] += by;
    }
    const Given given = read_stamps(stamps);
    EXPECT_THAT(given.counters.rejected, IsEmpty());
    ASSERT_EQ(given.times.size(), 360U);
    EXPECT_TRUE(std::is_sorted(given.times.begin(), given.times.end()));
    EXPECT_EQ(given.times.back(), at(walk(120).back()));
    EXPECT_LT(std::chrono::abs(given.times.front() - at(kStart)), milliseconds(200));
    EXPECT_EQ(given.words.size(), 2U);
  }
}

// Standard input cannot be read ahead: times after the step follow the clock before it.
TEST(Field, AClockThatWasSetBackInAPipeGoesOnEvenly) {
  std::vector<std::int64_t> stamps = walk(40);
  for (std::size_t i = 60; i < stamps.size(); ++i) {
    stamps[i] -= kHour;
  }
  const Given given = read_piped(file_of(stamps));
  EXPECT_THAT(given.counters.rejected, IsEmpty());
  ASSERT_EQ(given.times.size(), 120U);
  EXPECT_TRUE(std::is_sorted(given.times.begin(), given.times.end()));
  EXPECT_LT(given.times.back() - at(walk(40).back()), milliseconds(1));
  ASSERT_EQ(given.words.size(), 1U);
  EXPECT_THAT(given.words[0], HasSubstr("packet 61 (byte "));
  EXPECT_THAT(given.words[0], HasSubstr("the clock was set back by 3599.9 s"));
  EXPECT_THAT(given.words[0], HasSubstr("at the beginning"));
}

TEST(Field, ReportsOddStampsOfAPipe) {
  std::vector<std::int64_t> stamps = walk(60);
  stamps[17] += kHour;
  for (std::size_t i = 120; i < stamps.size(); ++i) {
    stamps[i] += 24 * kHour;
  }
  const Given given = read_piped(file_of(stamps));
  ASSERT_EQ(given.words.size(), 2U);
  EXPECT_THAT(given.words[0], HasSubstr("packet 18 (byte "));
  EXPECT_THAT(given.words[1], HasSubstr("packet 121 (byte "));
  EXPECT_THAT(given.words[1], HasSubstr("the clock was set, or nothing was received"));
}

TEST(Field, PausesOfASurveyAndSparseRecordingsAreNoDamage) {
  std::vector<std::int64_t> stamps;
  for (int point = 0; point < 30; ++point) {
    const auto here = walk(5, kStart + point * (12 * kSecond));
    stamps.insert(stamps.end(), here.begin(), here.end());
  }
  for (int i = 1; i <= 20; ++i) {  // one each minute
    stamps.push_back(kStart + kHour + i * (60 * kSecond));
  }
  for (const Given& given : {read_stamps(stamps), read_piped(file_of(stamps))}) {
    EXPECT_THAT(given.counters.rejected, IsEmpty());
    ASSERT_EQ(given.times.size(), stamps.size());
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      ASSERT_EQ(given.times[i], at(stamps[i]));
    }
  }
  EXPECT_EQ(read_stamps(stamps).words.size(), 1U);
}

// A listing shows the recorded stamps, except for damaged ones.
TEST(Field, AListingShowsTheRecordedStamps) {
  std::vector<std::int64_t> stamps = walk(40);
  for (std::size_t i = 60; i < stamps.size(); ++i) {
    stamps[i] -= kHour;
  }
  stamps[20] += kHour;
  const Given given = read_stamps(stamps, as_stamped_options());
  EXPECT_EQ(given.counters.rejected, (Counts{{"damaged_time", 1}}));
  EXPECT_EQ(given.times.front(), at(stamps.front()));
  EXPECT_EQ(given.times.back(), at(stamps.back()));
}

// For any stamps, every record is counted, and nothing overflows.
TEST(Field, AnyStampsAreCounted) {
  std::mt19937 random(5);
  std::uniform_int_distribution<std::int64_t> anywhere(0, 4'294'967'295);
  std::uniform_int_distribution<int> dice(0, 9);
  for (int round = 0; round < 60; ++round) {
    std::vector<std::int64_t> stamps;
    std::int64_t now = anywhere(random) * kSecond;
    for (int i = 0; i < 200; ++i) {
      now = std::max<std::int64_t>(0, now + 30'000);
      now = dice(random) == 0 && round % 3 != 0 ? anywhere(random) * kSecond : now;
      stamps.push_back(dice(random) == 0 ? anywhere(random) * kSecond : now);
    }
    EXPECT_EQ(read_stamps(stamps).counters.received, 200U);
    EXPECT_EQ(read_stamps(stamps, as_stamped_options()).counters.received, 200U);
    EXPECT_EQ(read_piped(file_of(stamps)).counters.received, 200U);
  }
}

TEST(Field, SeveralFilesAreOneRecordingInAnyOrder) {
  const Folder folder;
  std::vector<std::string> files = {
      folder.write("ring.pcap0", file_of(walk(10), "a")),
      folder.write("ring.pcap1", file_of(walk(10, kStart + kSecond), "b")),
      folder.write("ring.pcap2.gz", test::gzip(file_of(walk(10, kStart + 2 * kSecond), "c")))};
  const auto stamps = walk(30);
  std::sort(files.begin(), files.end());
  do {
    const Given given = read_files(files);
    ASSERT_EQ(given.error, "");
    ASSERT_EQ(given.times.size(), stamps.size());
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      ASSERT_EQ(given.times[i], at(stamps[i]));
    }
    EXPECT_EQ(given.payloads[30], "b0");
    EXPECT_EQ(given.payloads[89], "c29");
    EXPECT_THAT(given.words, IsEmpty());
  } while (std::next_permutation(files.begin(), files.end()));
}

TEST(Field, AnEndlessRingTakesFewDescriptors) {
  const Folder folder;
  std::vector<std::string> files;
  files.reserve(100);
  for (int i = 0; i < 100; ++i) {
    files.push_back(
        folder.write("ring.pcap" + std::to_string(i), file_of(walk(2, kStart + i * kSecond / 5))));
  }
  auto source = RecordedSource::open(files);
  ASSERT_TRUE(source);
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                         std::filesystem::directory_iterator());
  };
  const auto before = open_files();
  DatagramBatch batch;
  std::size_t all = 0;
  while (!batch.ended) {
    ASSERT_TRUE((*source)->read(batch, seconds(1)));
    all += batch.datagrams.size();
    EXPECT_LE(open_files(), before + 2);
  }
  EXPECT_EQ(all, 600U);
}

TEST(Field, ReportsOverlapsAndGapsOfFiles) {
  const Folder folder;
  const std::string a = folder.write("a.pcap", file_of(walk(20), "a"));
  const std::string b = folder.write("b.pcap", file_of(walk(20, kStart + kSecond), "b"));
  const std::string c = folder.write("c.pcap", file_of(walk(20, kStart + 60 * kSecond), "c"));
  const Given given = read_files({c, b, a});
  ASSERT_EQ(given.words.size(), 2U);
  EXPECT_THAT(given.words[0], HasSubstr("a.pcap and "));
  EXPECT_THAT(given.words[0], HasSubstr("they overlap by 0.9 s"));
  EXPECT_THAT(given.words[1], HasSubstr("nothing was recorded for 57.1 s"));
  ASSERT_EQ(given.times.size(), 180U);
  EXPECT_TRUE(std::is_sorted(given.times.begin(), given.times.end()));
  EXPECT_EQ(given.payloads[30], "a30");
  EXPECT_EQ(given.payloads[31], "b0");  // within the overlap they alternate
}

TEST(Field, FilesThatCannotBeASequenceAreRefused) {
  const Folder folder;
  const std::string a = folder.write("a.pcap", file_of(walk(2)));
  EXPECT_THAT(read_files({a, a}).error, HasSubstr("a.pcap: is named twice"));
  EXPECT_THAT(read_files({a, "/dev/stdin"}).error, HasSubstr("a pipe cannot be one of several"));
  EXPECT_THAT(read_files({a, "/nowhere/b.pcap"}).error, HasSubstr("/nowhere/b.pcap"));
}

TEST(Field, AFileThatHoldsNothingIsNoEndOfTheSequence) {
  const Folder folder;
  const Given given =
      read_files({folder.write("a.pcap", file_of(walk(2))),
                  folder.write("b.pcap", test::pcap_header(kLittle, false)),
                  folder.write("c.pcap", file_of(walk(2, kStart + kSecond)).substr(0, 300))});
  EXPECT_EQ(given.error, "");
  EXPECT_EQ(given.counters.rejected, (Counts{{"torn_record", 1}}));
  EXPECT_GT(given.times.size(), 6U);
  ASSERT_EQ(given.words.size(), 1U);
  EXPECT_THAT(given.words[0], HasSubstr("c.pcap: byte "));
}

TEST(Field, MonitorModeCapturesYieldAdviceOnCapturing) {
  for (const std::uint32_t link_type : {105U, 119U, 127U, 163U, 192U}) {
    ByteString file = test::pcap_header(kLittle, false, link_type);
    file += test::pcap_record(kLittle, 1, 0, ByteString(66, '\0'));
    const Folder folder;
    const Given given = read_files({folder.write("air.pcap", file)});
    EXPECT_EQ(given.counters.rejected, (Counts{{"monitor_mode", 1}}));
    ASSERT_EQ(given.words.size(), 1U);
    EXPECT_THAT(given.words[0], HasSubstr("air.pcap: a capture in monitor mode"));
    EXPECT_THAT(given.words[0], HasSubstr("udp port 5500"));
  }
}

TEST(Field, BusyTimesExcludeRecordingGaps) {
  const Folder folder;
  std::vector<std::int64_t> stamps = walk(10);
  const auto later = walk(10, kStart + kHour);
  stamps.insert(stamps.end(), later.begin(), later.end());
  const auto a = plan_recording({folder.write("a.pcap", file_of(stamps))});
  const auto b = plan_recording({folder.write("b.pcap", file_of(walk(10, kStart + 5 * kSecond)))});
  ASSERT_TRUE(a && b);
  EXPECT_THAT(busy_times({*a, *b}),
              ElementsAre(TimeSpan{at(kStart), at(kStart + 5'900'020)},
                          TimeSpan{at(kStart + kHour), at(kStart + kHour + 900'020)}));
}

// A datagram that the kernel stamped behind a step that the clock's reading did not see yet.
TEST(Field, AStampAheadOfTheLiveClockGovernsNothing) {
  EventClock clock;
  const Timestamp now(seconds(1'700'000'000));
  clock.observe(now, seconds(100));
  EXPECT_LE(clock.event_time(now + std::chrono::hours(24)), now + seconds(1));
  EXPECT_EQ(clock.event_time(now + milliseconds(20)), now + milliseconds(20));
  clock.not_drained(clock.event_time(now + std::chrono::hours(24)));
  EXPECT_LE(clock.watermark(), now + seconds(1));
}

}  // namespace
}  // namespace rayloc::field_recordings_test
