#include "daemon/pipeline/device/device_rooms.h"

#include <memory>
#include <utility>

#include <gmock/gmock.h>

namespace rayloc::device_rooms_test {
namespace {

using ::testing::HasSubstr;

class NoPosition : public DeviceMethod {
 public:
  explicit NoPosition(DeviceMethodInput input) : input_(std::move(input)) {}

  const RoomModel& room() const override { return *input_.room; }
  LocationEstimate locate(std::span<const CsiFrame>, std::uint64_t) const override { return {}; }
  std::size_t listed() const { return input_.listed.size(); }

 private:
  DeviceMethodInput input_;
};

Expected<std::unique_ptr<DeviceMethod>> make_method(DeviceMethodInput input) {
  return std::make_unique<NoPosition>(std::move(input));
}
Expected<std::unique_ptr<DeviceMethod>> fail_to_make(DeviceMethodInput /*input*/) {
  return make_error(ErrorKind::kConfiguration, "no such room");
}

constexpr Method kNoPosition = {
    .name = "none", .summary = "", .domain = "", .create_device = &make_method};
constexpr Method kFails = {
    .name = "fails", .summary = "", .domain = "", .create_device = &fail_to_make};

// Two devices at one height, one at another, and a fixed transmitter.
Site site_of_devices() {
  Site site;
  site.directory = "/hall";
  for (const double height : {0.8, 0.8, 1.6}) {
    SiteTransmitter& device = site.transmitters.emplace_back();
    device.mac.octets[5] = static_cast<std::uint8_t>(site.transmitters.size());
    device.height = height;
  }
  SiteTransmitter& fixed = site.transmitters.emplace_back();
  fixed.role = TransmitterRole::kFixed;
  fixed.height = 2.0;
  return site;
}

TEST(DeviceRooms, HaveOneInstanceForEachDeviceModel) {
  const Site site = site_of_devices();
  DeviceRooms rooms(site);
  ASSERT_TRUE(rooms.prepare(kNoPosition, {}, {}));
  ASSERT_EQ(rooms.all().size(), 3U) << "that of unlisted devices, and those of two heights";
  EXPECT_EQ(&rooms.of(nullptr), &rooms.all()[0]);
  EXPECT_EQ(&rooms.of(&site.transmitters[0]), &rooms.of(&site.transmitters[1]));
  EXPECT_NE(&rooms.of(&site.transmitters[0]), &rooms.of(&site.transmitters[2]));
  for (const DeviceRoom& room : rooms.all()) {
    EXPECT_EQ(room.room().device, room.device);
    EXPECT_EQ(dynamic_cast<const NoPosition&>(*room.method).listed(), 4U);
  }
}

TEST(DeviceRooms, OfAMethodWithoutCapabilitiesHaveNeitherTracksNorLearners) {
  const Site site = site_of_devices();
  DeviceRooms rooms(site);
  ASSERT_TRUE(rooms.prepare(kNoPosition, {}, {}));
  EXPECT_TRUE(rooms.learners().empty());
  EXPECT_FALSE(rooms.has_track(site.transmitters[0].mac));
  const Timestamp now(std::chrono::seconds(7));
  EXPECT_EQ(rooms.received_until(now), now);
  EXPECT_EQ(rooms.tracker_counters().begun, 0U);
}

TEST(DeviceRooms, RefuseASiteWithoutDevices) {
  Site site = site_of_devices();
  site.transmitters.erase(site.transmitters.begin(), site.transmitters.begin() + 3);
  site.targets.track_unlisted = false;
  const auto prepared = DeviceRooms(site).prepare(kNoPosition, {}, {});
  ASSERT_FALSE(prepared);
  EXPECT_EQ(prepared.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(prepared.error().message, HasSubstr("/hall/site.toml: no device to locate"));
}

TEST(DeviceRooms, ReportTheErrorOfTheMethod) {
  const Site site = site_of_devices();
  const auto prepared = DeviceRooms(site).prepare(kFails, {}, {});
  ASSERT_FALSE(prepared);
  EXPECT_EQ(prepared.error().message, "no such room");
}

}  // namespace
}  // namespace rayloc::device_rooms_test
