// Several access points on one source, and datagrams of another channel: no frame is made of
// either.
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/assemble/csi_receiver.h"
#include "capture/assemble/mixture_detector.h"
#include "tests/support/public_captures.h"
#include "tests/support/recording.h"
#include "tests/support/wire_writer.h"

namespace rayloc::mixture_test {
namespace {

using test::PublicCaptures;
using test::Recording;
using test::WireFrame;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;
using ::testing::SizeIs;

using Milliseconds = std::chrono::milliseconds;

constexpr Timestamp kStart{std::chrono::seconds(1'000)};
constexpr const char* kSeveral = "several_access_points";

CsiReceiverOptions strict() {
  CsiReceiverOptions options;
  options.expected_rx_chains = {0, 1, 2, 3};
  options.reject_mixture = true;
  options.settle = Milliseconds(250);
  return options;
}

// Frames of one access point: every `step`, counted up from `counter`.
struct Stream {
  int counter = 1;
  int first_number = 1;  // 802.11 sequence number
  double delay = 100e-9;
  Duration begin{};
  Duration step = Milliseconds(100);
  std::uint64_t transmitter = 0x02524c000001;
  int repetitions = 1;  // transmissions of each 802.11 frame
};

Recording axcsi(const Stream& stream, int count) {
  Recording all;
  for (int i = 0; i < count * stream.repetitions; ++i) {
    WireFrame frame;
    frame.transmitter = stream.transmitter;
    frame.sequence = static_cast<std::uint16_t>(stream.counter + i);
    frame.sequence_control =
        static_cast<std::uint16_t>((stream.first_number + i / stream.repetitions) << 4);
    frame.channel = test::delayed_path(stream.delay + 1e-9 * i, 312'500.0);
    const Recording datagrams =
        test::write_axcsi(frame,
                          kStart + stream.begin + (i / stream.repetitions) * stream.step +
                              std::chrono::microseconds(300) * (i % stream.repetitions));
    all.insert(all.end(), datagrams.begin(), datagrams.end());
  }
  return all;
}

Recording nexmon(const Stream& stream, int count) {
  Recording all;
  for (int i = 0; i < count; ++i) {
    WireFrame frame;
    frame.channel_mhz = frame.occupied_mhz = 80;
    frame.sequence_control = static_cast<std::uint16_t>((stream.first_number + i) << 4);
    frame.channel = test::delayed_path(stream.delay + 1e-9 * i, 312'500.0);
    const Recording datagrams = test::write_nexmon(
        frame, test::NexmonChip::k43455c0, 2, kStart + stream.begin + i * stream.step);
    all.insert(all.end(), datagrams.begin(), datagrams.end());
  }
  return all;
}

Recording merged(Recording a, const Recording& b) {
  a.insert(a.end(), b.begin(), b.end());
  std::stable_sort(
      a.begin(), a.end(), [](const auto& x, const auto& y) { return x.time < y.time; });
  return a;
}

struct Received {
  std::vector<CsiFrame> frames;
  CsiReceiverCounters counters;
};

Received receive(const Recording& recording, CsiReceiverOptions options = strict()) {
  CsiReceiver receiver(std::move(options));
  Received received;
  received.frames = test::receive_all(receiver, recording);
  received.counters = receiver.counters();
  return received;
}

void expect_nothing_of_it(const Recording& recording, const char* evidence) {
  const Received received = receive(recording);
  EXPECT_THAT(received.frames, IsEmpty());
  EXPECT_EQ(received.counters.rejected.at(kSeveral) + received.counters.duplicates,
            recording.size());
  EXPECT_THAT(received.counters.trouble, HasSubstr(evidence));
}

TEST(Field, TwoFrameCountersOnOneSourceGiveNoFrame) {
  Stream second{.counter = 20'000, .delay = 40e-9, .begin = Milliseconds(1)};
  expect_nothing_of_it(merged(axcsi({}, 20), axcsi(second, 20)), "frame counters");
}

TEST(Field, TwoAccessPointsWhoseCountersAreEqualGiveNoFrame) {
  Stream second{.delay = 40e-9, .begin = Milliseconds(1)};
  expect_nothing_of_it(merged(axcsi({}, 20), axcsi(second, 20)), "frame counter");
}

TEST(Field, TwoAccessPointsWhoseCountersAreNearlyEqualGiveNoFrame) {
  Stream second{.counter = 4, .delay = 40e-9, .begin = Milliseconds(1)};
  const Received received = receive(merged(axcsi({}, 60), axcsi(second, 60)));
  EXPECT_THAT(received.counters.trouble, HasSubstr("frame counter"));
  EXPECT_LT(received.frames.size(), 12U) << "before a counter value came twice";
}

TEST(Field, TwoSendersOnOneSourceGiveNoFrame) {
  CsiReceiver receiver(strict());
  std::vector<CsiFrame> frames;
  Stream stream;
  const Recording recording = axcsi(stream, 40);
  for (std::size_t i = 0; i < recording.size(); ++i) {
    Datagram datagram = recording[i].view();
    datagram.address.source_ip += static_cast<std::uint32_t>(i % 2);
    receiver.push(datagram, frames);
  }
  receiver.flush(frames);
  EXPECT_THAT(frames, IsEmpty());
  EXPECT_THAT(receiver.counters().trouble, HasSubstr("sender"));
}

TEST(Field, TwoNexmonAccessPointsOnOneSourceAreNamed) {
  Stream second{.delay = 40e-9, .begin = std::chrono::microseconds(400)};
  const Received received = receive(merged(nexmon({}, 60), nexmon(second, 60)));
  EXPECT_THAT(received.counters.trouble, HasSubstr("sequence number"));
  EXPECT_GT(received.counters.rejected.at(kSeveral), received.counters.received / 2);
}

TEST(Field, ASecondAccessPointThatIsSwitchedOnLaterGivesNoFrameFromThenOn) {
  Stream second{
      .counter = 20'000, .first_number = 101, .delay = 40e-9, .begin = std::chrono::seconds(10)};
  const Received received = receive(merged(axcsi({}, 200), axcsi(second, 100)));
  ASSERT_EQ(received.frames.size(), 101U) << "the ten seconds before";
  EXPECT_LE(received.frames.back().time, kStart + std::chrono::seconds(10));
  EXPECT_FALSE(received.counters.trouble.empty());
}

TEST(Field, AMixtureThatIsOverIsLocatedAgain) {
  Stream second{.counter = 20'000, .delay = 40e-9, .begin = Milliseconds(1)};
  const Received received = receive(merged(axcsi({}, 600), axcsi(second, 20)));
  EXPECT_THAT(received.counters.troubles, SizeIs(1));
  EXPECT_TRUE(received.counters.trouble.empty());
  EXPECT_GT(received.frames.size(), 200U);
  EXPECT_GT(received.frames.front().time, kStart + std::chrono::seconds(30));
}

// Recordings of healthy access points.
TEST(Field, OneAccessPointIsNoMixture) {
  const auto expect_all = [](const Recording& recording, const char* what) {
    const Received received = receive(recording);
    EXPECT_TRUE(received.counters.troubles.empty()) << what;
    EXPECT_EQ(received.counters.in_frames + received.counters.duplicates, recording.size()) << what;
  };
  expect_all(axcsi({.repetitions = 2}, 60), "retransmissions");
  expect_all(axcsi({.counter = 65'500}, 100), "a counter that wraps round");
  expect_all(merged(axcsi({}, 50), axcsi({.counter = 9'000, .begin = std::chrono::seconds(6)}, 50)),
             "a restart");
  Recording twice = axcsi({}, 40);
  expect_all(merged(twice, twice), "datagrams that the network repeats");
  Recording lossy;
  for (int i = 0; i < 10; ++i) {
    const Recording part = axcsi(
        {.counter = 1 + 500 * i, .first_number = 1 + 7 * i, .begin = std::chrono::seconds(2) * i},
        10);
    lossy.insert(lossy.end(), part.begin(), part.end());
  }
  expect_all(lossy, "losses of hundreds of frames");
  expect_all(merged(axcsi({}, 50),
                    axcsi({.counter = 9'000,
                           .begin = std::chrono::milliseconds(50),
                           .transmitter = 0x02524c000002},
                          50)),
             "devices that were recorded one after the other and merged");
  expect_all(merged(axcsi({}, 30), axcsi({.begin = std::chrono::seconds(3)}, 30)),
             "a recording that is sent again");
  expect_all(nexmon({}, 60), "nexmon");
}

// A survey that is sent point by point: the counter begins again with each recording, and each is
// lost in part.
TEST(Field, RecordingsThatAreSentOneAfterTheOtherAreNoMixture) {
  const Duration step = Milliseconds(40);
  for (const int count : {12, 25, 90, 300}) {  // frames of each recording, which differ in length
    for (const int frames_apart : {0, 7}) {    // between the 802.11 numbers of two recordings
      for (const int lost : {0, 7, 22, 5}) {   // one datagram of so many; 0: none
        Recording sent;
        for (int i = 0; i < 6; ++i) {
          Recording one = axcsi({.first_number = 1 + frames_apart * i,
                                 .delay = 40e-9 * (i + 1),
                                 .begin = i * (count + 10) * step,
                                 .step = step},
                                count + 1 + i % 3);
          for (std::size_t n = one.size(); lost > 0 && n-- > 0;) {
            if ((static_cast<int>(n) + i) % lost == 0) {
              one.erase(one.begin() + static_cast<std::ptrdiff_t>(n));
            }
          }
          sent.insert(sent.end(), one.begin(), one.end());
        }
        const Received received = receive(sent);
        EXPECT_TRUE(received.counters.troubles.empty())
            << count << " frames, " << frames_apart << " apart, one datagram lost of " << lost;
        EXPECT_EQ(received.counters.rejected.count(kSeveral), 0U);
      }
    }
  }
}

TEST_F(PublicCaptures, AreOfOneAccessPointEach) {
  for (const char* name : {"axcsi-rt-ax86u/middle.pcap",
                           "axcsi-rt-ax86u/extreme.pcap",
                           "axcsi-rt-ax86u/AllData.pcap",
                           "ubilocate-rt-ac86u/test_ch_bw_trace4.pcap",
                           "nexmon-csikit/example_4366c0.pcap",
                           "nexmon-csikit/example_43455c0.pcap",
                           "nexmon-csikit/example_4339.pcap"}) {
    CsiReceiverOptions options;
    options.reject_mixture = true;
    EXPECT_THAT(receive(test::read_public_capture(name), options).counters.troubles, IsEmpty())
        << name;
  }
}

// The chanspec of AX-CSI lies at byte 52.
Recording on_channel(Recording recording, std::uint16_t chanspec) {
  for (auto& datagram : recording) {
    datagram.payload[52] = static_cast<std::byte>(chanspec & 0xffU);
    datagram.payload[53] = static_cast<std::byte>(chanspec >> 8U);
  }
  return recording;
}

constexpr std::uint16_t k5190At40 = 0xd826;
constexpr std::uint16_t k5755At40 = 0xd997;
constexpr std::uint16_t k5210At80 = 0xe02a;
constexpr std::uint16_t kNoChannel = 0xffff;

TEST(Field, FramesOfAnotherChannelThanTheSitesAreRejectedByName) {
  CsiReceiverOptions options = strict();
  options.channel = RadioChannel{5190e6, 40};
  const Recording recording = axcsi({}, 10);
  EXPECT_EQ(receive(on_channel(recording, k5190At40), options).frames.size(), 10U);
  EXPECT_EQ(receive(on_channel(recording, kNoChannel), options).frames.size(), 10U);
  for (const std::uint16_t other : {k5755At40, k5210At80}) {
    const Received received = receive(on_channel(recording, other), options);
    EXPECT_THAT(received.frames, IsEmpty());
    EXPECT_EQ(received.counters.rejected.at("other_channel"), recording.size());
    EXPECT_THAT(received.counters.trouble, HasSubstr("5190 MHz (40 MHz wide)"));
    EXPECT_THAT(
        received.counters.trouble,
        HasSubstr(other == k5755At40 ? "5755 MHz (40 MHz wide)" : "5210 MHz (80 MHz wide)"));
  }
}

TEST(Field, AFrameStatesItsChannel) {
  const Received received = receive(on_channel(axcsi({}, 3), k5755At40), {});
  ASSERT_EQ(received.frames.size(), 3U);
  EXPECT_EQ(received.frames[0].channel, (RadioChannel{5755e6, 40}));
}

TEST(Field, AHopInARecordingIsAnEventWithItsTime) {
  CsiReceiverOptions options = strict();
  options.channel = RadioChannel{5190e6, 40};
  Recording hopping = on_channel(axcsi({}, 10), k5190At40);
  const Recording away = on_channel(
      axcsi({.counter = 11, .first_number = 11, .begin = std::chrono::seconds(1)}, 10), k5755At40);
  const Recording back = on_channel(
      axcsi({.counter = 21, .first_number = 21, .begin = std::chrono::seconds(2)}, 10), k5190At40);
  hopping = merged(merged(hopping, away), back);
  const Received received = receive(hopping, options);
  EXPECT_EQ(received.frames.size(), 20U);
  EXPECT_EQ(received.counters.channel_changes, 2U);
  ASSERT_THAT(received.counters.first_changes, SizeIs(2));
  EXPECT_EQ(received.counters.first_changes[0].time, kStart + std::chrono::seconds(1));
  EXPECT_EQ(received.counters.first_changes[0].to, (RadioChannel{5755e6, 40}));
  EXPECT_TRUE(received.counters.trouble.empty()) << "the site's channel again";
  EXPECT_THAT(received.counters.troubles, SizeIs(1));
}

// A device that hops: one access point, one counter, channels of the site's band and width.
TEST(CsiReceiver, TakesTheHopsOfADeviceAndNoOtherChannel) {
  constexpr std::uint16_t k2437At40 = 0x1806;
  Recording hopping;
  for (int hop = 0; hop < 4; ++hop) {
    hopping = merged(hopping,
                     on_channel(axcsi({.counter = 1 + 5 * hop,
                                       .first_number = 1 + 5 * hop,
                                       .begin = std::chrono::seconds(hop)},
                                      5),
                                hop % 2 == 0 ? k5190At40 : k5755At40));
  }
  CsiReceiverOptions options = strict();
  options.channel = RadioChannel{5190e6, 40};
  EXPECT_EQ(receive(hopping, options).frames.size(), 10U);
  options.accepts_hops = true;
  const Received all = receive(hopping, options);
  EXPECT_EQ(all.frames.size(), 20U);
  EXPECT_THAT(all.counters.rejected, IsEmpty());
  EXPECT_THAT(all.counters.troubles, IsEmpty());
  EXPECT_EQ(all.counters.channel_changes, 0U);
  const std::uint64_t datagrams = hopping.size() / 2;
  EXPECT_EQ(all.counters.hops,
            (std::map<RadioChannel, std::uint64_t>{{{5190e6, 40}, datagrams},
                                                   {{5755e6, 40}, datagrams}}));
  for (const std::uint16_t other : {k5210At80, k2437At40}) {
    const Received rejected = receive(on_channel(axcsi({}, 5), other), options);
    EXPECT_THAT(rejected.frames, IsEmpty());
    EXPECT_EQ(rejected.counters.rejected.at("other_channel"), rejected.counters.received);
    EXPECT_THAT(rejected.counters.trouble, HasSubstr("5190 MHz (40 MHz wide)"));
  }
}

}  // namespace
}  // namespace rayloc::mixture_test
