// Recordings of the bundled walk in which something is wrong, through `rayloc replay`.
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "capture/record/pcap_recorder.h"
#include "capture/source/recorded_source.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::field_faulty_recordings_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSite = test::data_path("/sites/meeting_room");
constexpr std::size_t kRxChainAt = 8;  // of an AX-CSI payload
constexpr std::size_t kWordsAt = 54;   // WIRE_FORMATS 1.1

struct Record {
  Timestamp time;
  DatagramAddress address;
  std::vector<std::byte> payload;

  int rx_chain() const { return std::to_integer<int>(payload[kRxChainAt]); }
};
// False: the record is left out. `number`: of the record.
using Change = std::function<bool(std::size_t number, Record& record)>;

void rewrite(const std::string& from, const std::string& to, const Change& change) {
  fs::remove(to);
  auto source = RecordedSource::open({from}, {});
  ASSERT_TRUE(source) << source.error().message;
  auto recorder = PcapRecorder::create(to);
  ASSERT_TRUE(recorder) << recorder.error().message;
  DatagramBatch batch;
  std::size_t number = 0;
  while (!batch.ended) {
    ASSERT_TRUE((*source)->read(batch, std::chrono::seconds(1)));
    for (const Datagram& datagram : batch.datagrams) {
      Record record{
          datagram.time, datagram.address, {datagram.payload.begin(), datagram.payload.end()}};
      if (change(number++, record)) {
        const Datagram changed{record.time, record.address, record.payload};
        ASSERT_TRUE(recorder->write(std::span(&changed, 1)));
      }
    }
  }
  ASSERT_TRUE(recorder->sync());
}

class FieldRecordings : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::create_directories(folder());
    const Finished run = calibrate(kSite + "/calibration-ap1.pcap.gz");
    ASSERT_EQ(run.status, 0) << run.err;
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static Finished calibrate(const std::string& recording) {
    return RaylocProcess({"calibrate",
                          kSite,
                          "--gains-only",
                          "--quiet",
                          "--capture",
                          "ap1=" + recording,
                          "--points",
                          kSite + "/calibration.csv",
                          "--out",
                          path(fs::exists(path("site")) ? "other" : "site")})
        .wait();
  }

  struct Replay {
    std::string words;
    std::size_t snapshots = 0;
    std::size_t fixes = 0;
    std::size_t warned = 0;  // snapshots with a warning that holds `word`
  };
  // As recorded.
  static const Replay& healthy() {
    static const Replay kHealthy = replay([](std::size_t, Record&) { return true; });
    return kHealthy;
  }

  static Replay replay(const Change& change, const std::string& word = "core 2") {
    rewrite(kSite + "/walk-ap1.pcap.gz", path("walk.pcap"), change);
    const Finished run = RaylocProcess({"replay", path("site"), "ap1=" + path("walk.pcap")}).wait();
    EXPECT_EQ(run.status, 0) << run.err;
    Replay result{run.err};
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);) {
      const auto location = nlohmann::json::parse(line);
      if (location.at("kind") == "LOCATION_KIND_SNAPSHOT") {
        ++result.snapshots;
        result.fixes += location.contains("position") ? 1U : 0U;
        const std::string warnings = location.at("quality").at("warnings").dump();
        result.warned += warnings.find(word) != std::string::npos ? 1U : 0U;
      }
    }
    return result;
  }

  static fs::path folder() {
    return fs::path(::testing::TempDir()) / ("faulty_recordings_" + std::to_string(::getpid()));
  }
  static std::string path(const std::string& name) { return folder() / name; }
};

TEST_F(FieldRecordings, DeadCoreIsNamedAndTheOthersLocate) {
  EXPECT_EQ(healthy().warned, 0U);
  EXPECT_THAT(healthy().words, Not(HasSubstr("has no CSI")));
  const Change missing = [](std::size_t, Record& record) { return record.rx_chain() != 2; };
  const Change zero = [](std::size_t, Record& record) {
    if (record.rx_chain() == 2) {
      std::fill(record.payload.begin() + kWordsAt, record.payload.end(), std::byte{0});
    }
    return true;
  };
  for (const Change& change : {missing, zero}) {
    const Replay dead = replay(change);
    EXPECT_EQ(dead.snapshots, healthy().snapshots);
    EXPECT_GE(4 * dead.fixes, 3 * healthy().fixes);
    EXPECT_EQ(dead.warned, dead.snapshots);
    EXPECT_THAT(dead.words, AllOf(HasSubstr("core 2 has no CSI"), HasSubstr("pigtail")));
  }
}

TEST_F(FieldRecordings, CoreOfWhichSomeDatagramsAreLostIsNotDead) {
  const Replay lossy =
      replay([](std::size_t number, Record&) { return number % 11 != 3; }, "is dead");
  EXPECT_EQ(lossy.warned, 0U);
  EXPECT_THAT(lossy.words, Not(HasSubstr("has no CSI")));
}

TEST_F(FieldRecordings, CoreThatComesBackIsUsedAgain) {
  const Replay back = replay(
      [](std::size_t number, Record& record) { return record.rx_chain() != 2 || number > 120; });
  EXPECT_GT(back.warned, 0U);
  EXPECT_LT(back.warned, back.snapshots);
  EXPECT_GE(4 * back.fixes, 3 * healthy().fixes);
}

TEST_F(FieldRecordings, CalibrationIsNotBuiltOnADeadCore) {
  for (const bool is_zero : {false, true}) {
    rewrite(
        kSite + "/calibration-ap1.pcap.gz", path("survey.pcap"), [&](std::size_t, Record& record) {
          if (record.rx_chain() == 2 && is_zero) {
            std::fill(record.payload.begin() + kWordsAt, record.payload.end(), std::byte{0});
          }
          return record.rx_chain() != 2 || is_zero;
        });
    const Finished run = calibrate(path("survey.pcap"));
    EXPECT_NE(run.status, 0);
    EXPECT_THAT(run.err, AllOf(HasSubstr("access point ap1"), HasSubstr("core 2")));
    EXPECT_FALSE(fs::exists(path("other")));
  }
}

TEST_F(FieldRecordings, StampsThatDoNotAdvanceGiveNoPosition) {
  std::optional<Timestamp> first;
  const Replay same = replay([&](std::size_t, Record& record) {
    first = first.value_or(record.time);
    record.time = *first;
    return true;
  });
  EXPECT_EQ(same.fixes, 0U);
  EXPECT_THAT(same.words, AllOf(HasSubstr("walk.pcap"), HasSubstr("do not advance")));
  const Replay seconds = replay([&](std::size_t, Record& record) {
    record.time = Timestamp(std::chrono::floor<std::chrono::seconds>(record.time));
    return true;
  });
  EXPECT_LE(seconds.fixes, 1U) << "the walk begins with a second of a single frame";
  EXPECT_THAT(seconds.words, AllOf(HasSubstr("walk.pcap"), HasSubstr("whole seconds")));
}

TEST_F(FieldRecordings, AddressesThatNoDeviceHasAreNotTracked) {
  for (const bool is_zero : {false, true}) {
    const Replay replayed = replay([&](std::size_t number, Record& record) {
      if (number % 2 == 0) {  // beside a device
        std::fill(record.payload.begin(),
                  record.payload.begin() + 6,
                  is_zero ? std::byte{0} : std::byte{255});
      }
      return true;
    });
    EXPECT_THAT(replayed.words, HasSubstr(is_zero ? "zero_address" : "group_address"));
  }
}

}  // namespace
}  // namespace rayloc::field_faulty_recordings_test
