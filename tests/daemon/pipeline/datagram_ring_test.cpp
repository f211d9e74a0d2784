// The most recent datagrams, within time and bytes, and the files that are made of them.
#include "daemon/pipeline/record/datagram_ring.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>

#include "capture/source/pcap_source.h"
#include "daemon/pipeline/record/ring_snapshots.h"
#include "tests/support/eventually.h"
#include "tests/support/read_to_end.h"

namespace rayloc::datagram_ring_test {
namespace {

using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{60};

// One datagram each `step`, numbered by its microseconds.
void tap(DatagramRing& ring, int from, int count, Duration step, std::size_t bytes = 500) {
  const std::vector<std::byte> payload(bytes);
  for (int i = from; i < from + count; ++i) {
    const Datagram datagram{Timestamp(i * step), {}, payload};
    ring.tap({&datagram, 1});
  }
}

std::vector<Timestamp> times_in(DatagramRing& ring) {
  std::vector<Timestamp> times;
  for (const auto& piece : ring.contents()) {
    for (const Datagram& datagram : piece->datagrams()) {
      times.push_back(datagram.time);
    }
  }
  return times;
}

TEST(DatagramRing, HoldsTheLastSeconds) {
  DatagramRing ring(std::chrono::seconds(30), std::size_t{1} << 30U);
  EXPECT_TRUE(times_in(ring).empty());
  constexpr Duration kStep = std::chrono::milliseconds(10);
  tap(ring, 0, 10'000, kStep);
  const std::vector<Timestamp> times = times_in(ring);
  EXPECT_EQ(times.back(), Timestamp(9'999 * kStep));
  EXPECT_GE(times.size(), 3000U);
  EXPECT_LE(times.size(), 3000U + 60) << "more than a piece beyond";
  for (std::size_t i = 1; i < times.size(); ++i) {
    ASSERT_EQ(times[i] - times[i - 1], kStep);
  }
}

TEST(DatagramRing, StaysWithinItsBytes) {
  constexpr std::size_t kMost = std::size_t{1} << 20U;
  DatagramRing ring(std::chrono::hours(1), kMost);
  for (int i = 0; i < 100; ++i) {
    tap(ring, i * 100, 100, std::chrono::microseconds(1));
    std::size_t bytes = 0;
    for (const auto& piece : ring.contents()) {
      bytes += piece->bytes();
    }
    ASSERT_LE(bytes, kMost);
  }
  EXPECT_GT(times_in(ring).size(), 1500U);
}

TEST(DatagramRing, ReservesNoMoreThanItHolds) {
  DatagramRing ring(std::chrono::hours(1), std::size_t{1} << 20U);
  tap(ring, 0, 5000, std::chrono::microseconds(1), 634);
  std::size_t held = 0;
  std::size_t reserved = 0;
  for (const auto& piece : ring.contents()) {
    held += piece->bytes();
    reserved +=
        piece->payloads.capacity() + piece->entries.capacity() * sizeof(DatagramRing::Piece::Entry);
  }
  EXPECT_GT(held, std::size_t{1} << 19U);
  EXPECT_LE(reserved, held + held / 20);
}

class RingSnapshotsTest : public ::testing::Test {
 protected:
  RingSnapshotsTest() { std::filesystem::remove_all(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  const RingSnapshots::Limits limits_{std::uint64_t{1} << 30U, 0};
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("ring_snapshots." + std::to_string(getpid()));
};

TEST_F(RingSnapshotsTest, WritesAFileForEachSourceWithDatagrams) {
  DatagramRing received(std::chrono::seconds(30), std::size_t{1} << 30U);
  DatagramRing silent(std::chrono::seconds(30), std::size_t{1} << 30U);
  RingSnapshots snapshots({{"ap1", &received}, {"ap2", &silent}}, folder_, limits_);
  EXPECT_THAT(snapshots.request().error().message, HasSubstr("no source has received"));
  tap(received, 1, 1000, std::chrono::milliseconds(1));
  const auto files = snapshots.request();
  ASSERT_TRUE(files) << files.error().message;
  ASSERT_EQ(files->size(), 1U);
  EXPECT_THAT(files->front(), HasSubstr("/ap1-snapshot-2"));
  ASSERT_TRUE(eventually(kPatience, [&] { return snapshots.counters().files == 1; }));
  const auto source = PcapFileSource::open(files->front()).value();
  test::read_to_end(*source);
  EXPECT_EQ(source->counters().delivered, 1000U);
  const std::vector<std::string> notices = snapshots.notices();
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0], "snapshot: " + files->front() + ": 1000 datagrams");
  EXPECT_TRUE(snapshots.notices().empty());
}

TEST_F(RingSnapshotsTest, ReportsTheReasonIfNothingIsWritten) {
  DatagramRing ring(std::chrono::seconds(30), std::size_t{1} << 30U);
  tap(ring, 1, 10, std::chrono::milliseconds(1));
  RingSnapshots snapshots(
      {{"ap1", &ring}}, folder_, {limits_.max_total_bytes, std::uint64_t{1} << 60U});
  ASSERT_TRUE(snapshots.request());
  ASSERT_TRUE(eventually(kPatience, [&] { return snapshots.counters().failed == 1; }));
  EXPECT_THAT(snapshots.notices().at(0), HasSubstr("less than min_free_mb would be left"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

// The limits of a reload replace those of the start.
TEST_F(RingSnapshotsTest, KeepsToTheLimitsSetLast) {
  DatagramRing ring(std::chrono::seconds(30), std::size_t{1} << 30U);
  tap(ring, 1, 10, std::chrono::milliseconds(1));
  RingSnapshots snapshots(
      {{"ap1", &ring}}, folder_, {limits_.max_total_bytes, std::uint64_t{1} << 60U});
  snapshots.set_limits(limits_);
  const auto kept = snapshots.request();
  ASSERT_TRUE(kept);
  ASSERT_TRUE(eventually(kPatience, [&] { return snapshots.counters().files == 1; }));
  EXPECT_TRUE(std::filesystem::exists(kept->front()));
  snapshots.set_limits({1, 0});
  const auto next = snapshots.request();
  ASSERT_TRUE(next) << next.error().message;
  ASSERT_TRUE(eventually(kPatience, [&] { return snapshots.counters().files == 2; }));
  EXPECT_FALSE(std::filesystem::exists(kept->front())) << "one byte in total";
}

// The rings go on while their contents are written; run under TSan.
TEST_F(RingSnapshotsTest, DisturbsNoReceiver) {
  DatagramRing ring(std::chrono::seconds(1), std::size_t{4} << 20U);
  tap(ring, 0, 100, std::chrono::microseconds(100));
  RingSnapshots snapshots({{"ap1", &ring}}, folder_, limits_);
  std::atomic<bool> ending = false;
  std::thread receiver([&] {
    for (int i = 1; !ending; ++i) {
      tap(ring, i * 100, 100, std::chrono::microseconds(100));
    }
  });
  EXPECT_TRUE(eventually(kPatience, [&] {
    (void)snapshots.request();  // refused while one is being written
    return snapshots.counters().files >= 10;
  }));
  ending = true;
  receiver.join();
  EXPECT_EQ(snapshots.counters().failed, 0U);
}

}  // namespace
}  // namespace rayloc::datagram_ring_test
