// From the tracer through the radio, the wire and the product's decoder back to the channel.
#include "daemon/lab/simulate/capture_simulator.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/channel/tone_plan.h"
#include "tests/support/recording.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::capture_simulator_test {
namespace {

using std::chrono::milliseconds;
using Value = std::complex<double>;

constexpr Vec3d kPlace{0.3, -0.4, 1.2};

CaptureOptions options_with(const Impairments& impairments) {
  CaptureOptions options;
  options.transmitter = {{2, 0x52, 0x4c, 0, 0, 7}};
  options.impairments = impairments;
  options.seed = 11;
  return options;
}

SimulatedPoint test_point_with(int frames) {
  SimulatedPoint test_point{2, kPlace, {}};
  for (int n = 0; n < frames; ++n) {
    test_point.frames.push_back({Timestamp(milliseconds(1000 + 10 * n)),
                                 static_cast<std::uint16_t>(16 * n),
                                 static_cast<std::uint64_t>(n)});
  }
  return test_point;
}

std::vector<CsiFrame> receive(const PointCapture& capture) {
  test::Recording recording;
  for (const SimulatedDatagram& datagram : capture.datagrams) {
    recording.push_back({datagram.time, datagram.payload});
  }
  CsiReceiver receiver(CsiReceiverOptions{});
  return test::receive_all(receiver, recording);
}

TEST(CaptureSimulator, WithoutImpairmentsTheDecoderGivesTheTracersChannel) {
  const RoomModel room = test::make_room();
  CaptureSimulator simulator(room, 1, options_with(no_impairments()));
  const auto frames = receive(*simulator.capture(test_point_with(3)));
  ASSERT_EQ(frames.size(), 3U);

  const RoomAccessPoint& ap = room.access_points[1];
  const PathTracer tracer(room.scene);
  const Transmitter device{{kPlace, {}, room.device.pattern, room.device.polarization}};
  const OfdmGrid grid{room.grid.centre_hz, room.grid.spacing_hz, frames[0].tone_index};
  ASSERT_EQ(grid.size(), 114U);
  for (std::size_t element = 0; element < ap.rx_chains.size(); ++element) {
    // One after the other, by trees that are made for this link alone.
    const auto h = tracer.trace(device, array_elements<Receiver>(ap.array)[element]).cfr(grid);
    const auto rx_chain = static_cast<std::size_t>(
        std::find(frames[0].rx_chains.begin(), frames[0].rx_chains.end(), ap.rx_chains[element]) -
        frames[0].rx_chains.begin());
    for (const CsiFrame& frame : frames) {
      const auto row = frame.csi.row(rx_chain, 0);
      for (std::size_t k = 0; k < grid.size(); ++k) {
        const Value received = Value(row[k]) / 0x1p30;
        const double largest = std::max(std::abs(h[k].real()), std::abs(h[k].imag()));
        // 11 bits of the larger part: half a step of 2^-10, rounded up where the mantissa is full.
        EXPECT_NEAR(received.real(), h[k].real(), largest / 1024.0) << k;
        EXPECT_NEAR(received.imag(), h[k].imag(), largest / 1024.0) << k;
      }
    }
  }
}

// Each frame has the scene's channel at its frequency. There is one radio: its counter goes on.
TEST(CaptureSimulator, HopsGiveTheChannelAtEachFrequency) {
  std::vector<RoomModel> rooms(3, test::make_room());
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    rooms[i].grid.centre_hz += 40e6 * static_cast<double>(i);
    const Scene& scene = *rooms[i].scene;
    auto other = Scene::create({scene.objects(), scene.materials(), rooms[i].grid.centre_hz});
    ASSERT_TRUE(other);
    rooms[i].scene = std::make_shared<const Scene>(*std::move(other));
  }
  SimulatedPoint test_point = test_point_with(6);
  for (std::size_t n = 0; n < test_point.frames.size(); ++n) {
    test_point.frames[n].channel = n % 3;
  }
  CaptureSimulator simulator(rooms, 0, options_with(no_impairments()));
  auto frames = receive(*simulator.capture(test_point));
  std::sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;  // the first ones wait for a time-out
  });
  ASSERT_EQ(frames.size(), 6U);
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const RoomModel& room = rooms[n % 3];
    EXPECT_EQ(frames[n].channel, (RadioChannel{room.grid.centre_hz, 40}));
    EXPECT_EQ(frames[n].sequence, frames[0].sequence + static_cast<int>(n));
    SimulatedPoint alone = test_point_with(1);
    const auto there =
        receive(*CaptureSimulator(room, 0, options_with(no_impairments())).capture(alone));
    ASSERT_EQ(there.size(), 1U);
    for (std::size_t rx_chain = 0; rx_chain < 3; ++rx_chain) {
      const auto row = frames[n].csi.row(rx_chain, 0);
      const auto expected = there[0].csi.row(rx_chain, 0);
      EXPECT_TRUE(std::equal(row.begin(), row.end(), expected.begin())) << n;
    }
  }
}

TEST(CaptureSimulator, FramesOfAHopHaveNoiseOfTheirOwn) {
  const std::vector<RoomModel> rooms(2, test::make_room());
  SimulatedPoint test_point = test_point_with(2);
  test_point.frames[1].channel = 1;
  CaptureSimulator simulator(rooms, 0, options_with(default_impairments()));
  EXPECT_EQ(simulator.chains(0).gain, simulator.chains(1).gain);
  const auto frames = receive(*simulator.capture(test_point));
  ASSERT_EQ(frames.size(), 2U);
  const auto first = frames[0].csi.row(0, 0);
  const auto second = frames[1].csi.row(0, 0);
  EXPECT_FALSE(std::equal(first.begin(), first.end(), second.begin()));
}

TEST(CaptureSimulator, DecodesToTheSimulatedFrames) {
  const RoomModel room = test::make_room();
  CaptureSimulator simulator(room, 0, options_with(default_impairments()));
  const auto frames = receive(*simulator.capture(test_point_with(2)));
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].transmitter, (MacAddress{{2, 0x52, 0x4c, 0, 0, 7}}));
  EXPECT_EQ(frames[0].phy, PhyFormat::kVht);
  EXPECT_EQ(frames[0].bandwidth_mhz, 40);
  EXPECT_EQ(frames[0].format, "axcsi-v4");
  EXPECT_EQ(frames[0].time, Timestamp(milliseconds(1000)));
  EXPECT_EQ(frames[1].sequence_control, 16);
  EXPECT_EQ(frames[1].sequence, frames[0].sequence + 1);
  EXPECT_TRUE(frames[0].complete);
}

// With the paths of less reflecting walls, and phases by the seed alone.
TEST(CaptureSimulator, RoughWallsScatterWhereThatIsAskedFor) {
  RoomModel room = test::make_room();
  RadioMaterial rough = room.scene->materials()[0];
  rough.scattering.scattering_coefficient = 0.5;
  auto scene = Scene::create({room.scene->objects(), {rough}, room.scene->carrier_hz()});
  ASSERT_TRUE(scene.has_value());
  room.scene = std::make_shared<const Scene>(*std::move(scene));
  const auto channel = [&](bool diffuse, std::uint64_t seed) {
    CaptureOptions options = options_with(no_impairments());
    options.trace.diffuse = diffuse;
    options.seed = seed;
    CaptureSimulator simulator(room, 1, options);
    const auto frames = receive(*simulator.capture(test_point_with(1)));
    std::vector<Value> h;
    for (std::size_t rx_chain = 0; rx_chain < frames.at(0).rx_chains.size(); ++rx_chain) {
      for (const auto& value : frames[0].csi.row(rx_chain, 0)) {
        h.emplace_back(value);
      }
    }
    return h;
  };
  const std::vector<Value> smooth = channel(false, 1);
  const std::vector<Value> scattered = channel(true, 1);
  EXPECT_EQ(scattered, channel(true, 1));
  EXPECT_NE(scattered, channel(true, 2));
  EXPECT_EQ(smooth, channel(false, 2));
  EXPECT_NE(scattered, smooth);
}

struct Channel {
  const char* name;
  int bandwidth_mhz;
  double spacing_hz;
  PhyFormat phy;
};

class CaptureOfChannel : public ::testing::TestWithParam<Channel> {};

// With noise and garbage, so that the decoder has to find what the frame occupies.
TEST_P(CaptureOfChannel, ComesBackOnAllItsTones) {
  RoomModel room = test::make_room();
  room.grid.spacing_hz = GetParam().spacing_hz;
  Impairments impairments = no_impairments();
  impairments.snr_db = 31.0;
  impairments.dc_garbage = true;
  CaptureOptions options = options_with(impairments);
  options.bandwidth_mhz = GetParam().bandwidth_mhz;
  CaptureSimulator simulator(room, 2, options);
  const auto frames = receive(*simulator.capture(test_point_with(1)));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].phy, GetParam().phy);
  EXPECT_EQ(frames[0].bandwidth_mhz, GetParam().bandwidth_mhz);
  EXPECT_EQ(frames[0].channel_bandwidth_mhz, GetParam().bandwidth_mhz);
  EXPECT_EQ(frames[0].tone_index, tone_plan(GetParam().phy, GetParam().bandwidth_mhz).active);

  const OfdmGrid grid{room.grid.centre_hz, GetParam().spacing_hz, frames[0].tone_index};
  const RoomAccessPoint& ap = room.access_points[2];
  const PathTracer tracer(room.scene);
  const auto paths =
      ArrayTracer(tracer, ap.array).trace(Transmitter{{kPlace, {}, room.device.pattern}});
  const auto h = paths[1].cfr(grid);  // core 0, the first row
  Value product;
  double own = 0.0;
  double theirs = 0.0;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const Value received(frames[0].csi.row(0, 0)[k]);
    product += std::conj(h[k]) * received;
    own += std::norm(h[k]);
    theirs += std::norm(received);
  }
  EXPECT_GT(std::norm(product) / (own * theirs), 0.999);  // the noise is 40 dB below at 1 m
}

INSTANTIATE_TEST_SUITE_P(Widths,
                         CaptureOfChannel,
                         ::testing::Values(Channel{"Vht20", 20, 312'500.0, PhyFormat::kVht},
                                           Channel{"Vht80", 80, 312'500.0, PhyFormat::kVht},
                                           Channel{"Vht160", 160, 312'500.0, PhyFormat::kVht},
                                           Channel{"He20", 20, 78'125.0, PhyFormat::kHe},
                                           Channel{"He80", 80, 78'125.0, PhyFormat::kHe}),
                         [](const auto& channel) { return std::string(channel.param.name); });

TEST(CaptureSimulator, TheSameSeedGivesTheSameBytes) {
  const RoomModel room = test::make_room();
  const auto bytes = [&](std::uint64_t seed, std::size_t access_point) {
    CaptureOptions options = options_with(default_impairments());
    options.seed = seed;
    std::vector<std::vector<std::byte>> payloads;
    auto received = CaptureSimulator(room, access_point, options).capture(test_point_with(2));
    for (auto& datagram : received->datagrams) {
      payloads.push_back(std::move(datagram.payload));
    }
    return payloads;
  };
  EXPECT_EQ(bytes(11, 0), bytes(11, 0));
  EXPECT_NE(bytes(11, 0), bytes(12, 0));
}

TEST(CaptureSimulator, LosesTheStatedShareOfDatagramsAndCountsThem) {
  const RoomModel room = test::make_room();
  Impairments impairments = no_impairments();
  impairments.loss_share = 0.2;
  CaptureSimulator simulator(room, 0, options_with(impairments));
  const PointCapture capture = *simulator.capture(test_point_with(500));
  EXPECT_EQ(capture.datagrams.size() + capture.lost, 1500U);
  EXPECT_NEAR(static_cast<double>(capture.lost), 300.0, 3 * 15.5);
}

// Outside the walls the access point receives no path: noise at the floor alone.
TEST(CaptureSimulator, CountsNoPathFromOutsideOfTheRoom) {
  const RoomModel room = test::make_room();
  CaptureSimulator simulator(room, 0, options_with(default_impairments()));
  SimulatedPoint outside = test_point_with(1);
  outside.position = {9.0, 0.0, 1.2};
  const PointCapture capture = *simulator.capture(outside);
  EXPECT_EQ(capture.paths, 0U);
  EXPECT_EQ(capture.datagrams.size(), 3U);
}

}  // namespace
}  // namespace rayloc::capture_simulator_test
