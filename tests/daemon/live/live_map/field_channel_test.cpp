// The channel that the map shows of a device that walks, and what it was located by.
#include <unistd.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <google/protobuf/util/time_util.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/live/live_map/map_channel.h"
#include "daemon/messages/proto_time.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/scene/build_room.h"
#include "daemon/site/scene/room_plan.h"
#include "daemon/site/scene/room_site.h"
#include "engine/observe/burst.h"
#include "engine/observe/chain_gains.h"
#include "tests/support/closet_plan.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::field_channel_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kSteps = 40;
constexpr const char* kDevice = "02:52:4c:00:00:01";

template <typename T>
T made(Expected<T> result) {
  if (!result) {
    throw std::runtime_error(result.error().message);
  }
  return *std::move(result);
}

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

// A closet with two access points, calibrated to the gains that test::frames_at() gives them, and
// a device with a name.
Site make_site(const fs::path& folder) {
  write(folder / "plan.toml",
        test::closet_plan() + test::closet_access_point("ap2", "[1.3, 0.9, 1.2]", -145));
  const RoomPlan plan = made(load_room_plan(folder / "plan.toml"));
  for (const auto& [name, content] : scene_files(build_room(plan))) {
    write(folder / name, content);
  }
  write(folder / "site.toml",
        room_site(plan) + "[[transmitter]]\nmac = \"" + std::string(kDevice) +
            "\"\nrole = \"device\"\nname = \"phone\"\n");
  Site site = made(load_site(folder));
  const RoomModel room = made(load_room_model(site));
  CalibrationFile calibration;
  calibration.id = "of the test";
  calibration.scene_hash = room.scene_hash;
  calibration.points_hash = "of none";
  calibration.likelihood_exponent = {room.likelihood_exponent, room.likelihood_exponent, 0.0};
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    CalibratedAccessPoint& one = calibration.access_points.emplace_back();
    one.id = room.access_points[i].id;
    one.points = 1;
    const ModelError usual;
    one.plan_tolerance = {usual.plan_tolerance, usual.plan_tolerance, 0.0};
    one.diffuse = {usual.diffuse, usual.diffuse, 0.0};
    one.noise = {usual.noise, usual.noise, 0.0};
    one.gains = test::make_gains(room, i);
    one.gain_sigma.assign(one.gains.rx_chains.size(), 0.0);
    one.element_y.assign(one.gains.rx_chains.size(), 0.0);
  }
  write(folder / "calibration.toml", to_toml(calibration));
  site.calibration_file = folder / "calibration.toml";
  return site;
}

// A walk at 1 m/s along x, with a frame every 5 ms.
Burst walk(const RoomModel& room, double from_x, Timestamp begin) {
  Burst burst;
  burst.transmitter = made(parse_mac_address(kDevice));
  for (int step = 0; step < kSteps; ++step) {
    const auto frames = test::frames_at(room,
                                        {from_x + 0.005 * step, -0.3, 1.2},
                                        {.count = 1, .seed = static_cast<unsigned>(step) + 1});
    for (CsiFrame frame : frames) {
      frame.time = frame.time_last = begin + step * std::chrono::milliseconds(5);
      frame.transmitter = burst.transmitter;
      burst.frames.push_back(std::move(frame));
    }
  }
  burst.first = burst.received_since = burst.frames.front().time;
  burst.last = burst.frames.back().time;
  return burst;
}

// The amplitudes of a burst at an access point, as the map draws them: of mean square 1.
std::vector<double> amplitudes(const RoomModel& room, std::size_t index, const Burst& burst) {
  const RoomAccessPoint& ap = room.access_points[index];
  auto received = made(combine_burst(burst.frames, {index, room.grid, ap.rx_chains, {}}));
  remove_gains(ap.gains, received.h);
  double power = 0.0;
  for (const auto& value : received.h) {
    power += std::norm(value) / static_cast<double>(received.h.size());
  }
  std::vector<double> list;
  for (const auto& value : received.h) {
    list.push_back(std::abs(value) / std::sqrt(power));
  }
  return list;
}

class FieldChannel {
 public:
  FieldChannel() { estimator_->channels().ask(); }
  ~FieldChannel() { fs::remove_all(folder_); }
  FieldChannel(const FieldChannel&) = delete;
  FieldChannel& operator=(const FieldChannel&) = delete;

  const RoomModel& room() const { return estimator_->room(); }
  DeviceEstimator& estimator() { return *estimator_; }
  Location locate(const Burst& burst) {
    Estimates out;
    estimator_->estimate(burst, out);
    return out.locations.front();
  }
  json shown() { return json::parse(map_.json()); }

 private:
  const fs::path folder_ =
      fs::path(::testing::TempDir()) / ("field_channel_" + std::to_string(::getpid()));
  const Site site_ = make_site(folder_);
  const std::unique_ptr<DeviceEstimator> estimator_ = made(DeviceEstimator::create(site_, {}));
  MapChannel map_{estimator_->channels()};
};

TEST(Field, TheChannelOfAWalkerIsOfTheBurstAndThePlaceThatItWasLocatedAt) {
  FieldChannel channel;
  for (const int second : {100, 101}) {  // and not of the one before
    const Burst burst =
        walk(channel.room(), 0.5 * (second - 100) - 0.6, Timestamp(std::chrono::seconds(second)));
    const Location location = channel.locate(burst);
    ASSERT_TRUE(location.estimate.position) << location.estimate.reason;
    const json all = channel.shown();
    ASSERT_EQ(all.size(), 1U);
    const json& shown = all.at(0);
    EXPECT_EQ(shown.at("target"), kDevice);
    EXPECT_EQ(shown.at("name"), "phone");
    EXPECT_EQ(shown.at("time"),
              google::protobuf::util::TimeUtil::ToString(to_proto(location.estimate.time)));
    EXPECT_EQ(shown.at("position"),
              json({location.estimate.position->x,
                    location.estimate.position->y,
                    location.estimate.position->z}));
    ASSERT_EQ(shown.at("access_points").size(), channel.room().access_points.size());
    for (std::size_t i = 0; i < 2; ++i) {
      const json& paths = shown.at("access_points").at(i).at("paths");
      ASSERT_GT(paths.size(), 1U) << "the direct way, and others";
      EXPECT_EQ(paths.at(0).at("level_db"), 0.0) << "the strongest first";
      EXPECT_EQ(paths.at(1).at("points").at(0), shown.at("position"));
      const Vec3d& there = channel.room().access_points[i].array.pose.position;
      EXPECT_EQ(paths.at(1).at("points").back(), json({there.x, there.y, there.z}));
      const std::vector<double> expected = amplitudes(channel.room(), i, burst);
      std::vector<double> measured;
      for (const json& antenna : shown.at("access_points").at(i).at("antennas")) {
        for (const double value : antenna.at("measured")) {
          measured.push_back(value);
        }
      }
      ASSERT_EQ(measured.size(), expected.size());
      for (std::size_t j = 0; j < measured.size(); ++j) {
        ASSERT_NEAR(measured[j], expected[j], 1e-3) << "access point " << i << ", value " << j;
      }
    }
  }
}

TEST(Field, NoChannelIsShownOfAnotherTime) {
  FieldChannel channel;
  channel.locate(walk(channel.room(), -0.6, Timestamp(std::chrono::seconds(100))));
  ASSERT_EQ(channel.shown().size(), 1U);
  Estimates none;
  channel.estimator().restart("the recording was moved to another place", none);
  EXPECT_TRUE(channel.shown().empty()) << "of before the move";

  // No request arrives for as long as a hundred bursts take.
  ChannelWatch watch;
  const auto add = [&](const std::string& target) {
    if (watch.is_wanted()) {
      watch.add({target, "", {}, {}, {}, nullptr});
    }
  };
  EXPECT_TRUE(watch.ask().empty());
  add("phone");
  EXPECT_EQ(watch.ask().size(), 1U);
  for (int i = 0; i < 150; ++i) {
    add(i < 50 ? "phone" : "laptop");
  }
  EXPECT_TRUE(watch.ask().empty()) << "of when somebody asked last";
  add("phone");
  EXPECT_EQ(watch.ask().size(), 1U);
}

}  // namespace
}  // namespace rayloc::field_channel_test
