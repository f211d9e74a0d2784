#include "daemon/lab/calibrate/inputs_hash.h"

#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace rayloc::inputs_hash_test {
namespace {

// The inputs of a calibration.
struct Inputs {
  Site site;
  RoomModel room = test::make_room();
  CalibrationRequest request{"joint", 0.2, 1, 0.005};
  std::string measurements = "heard";

  std::string hash() const { return inputs_hash(site, room, request, measurements); }
};

TEST(InputsHash, IsTheSameForTheSameInputs) { EXPECT_EQ(Inputs().hash(), Inputs().hash()); }

TEST(InputsHash, ChangesWithEverythingThatACalibrationStartsFrom) {
  const std::vector<std::function<void(Inputs&)>> changes = {
      [](Inputs& in) { in.measurements = "heard by others"; },
      [](Inputs& in) { in.request.method = "paper"; },
      [](Inputs& in) { in.request.holdout = 0.1; },
      [](Inputs& in) { in.request.seed = 2; },
      [](Inputs& in) { in.request.survey_error = 0.001; },
      [](Inputs& in) { in.room.scene_hash += "x"; },
      [](Inputs& in) { in.room.bounds_max.x += 0.1; },
      [](Inputs& in) { in.room.grid.centre_hz += 20e6; },
      [](Inputs& in) { in.room.grid.tone_index.pop_back(); },
      [](Inputs& in) { in.room.device.height += 0.1; },
      [](Inputs& in) { in.room.device.pattern = AntennaPattern::kTr38901; },
      [](Inputs& in) { in.room.access_points[0].id = "attic"; },
      [](Inputs& in) { in.room.access_points[0].array.pose.position.y += 0.01; },
      [](Inputs& in) { in.room.access_points[0].array.pose.orientation.yaw += 0.01; },
      [](Inputs& in) { in.room.access_points[0].array.element_offset[1].y += 0.001; },
      [](Inputs& in) { in.room.access_points[0].array.pattern = AntennaPattern::kTr38901; },
      [](Inputs& in) {
        std::swap(in.room.access_points[0].rx_chains[0], in.room.access_points[0].rx_chains[1]);
      },
      [](Inputs& in) {
        SiteTransmitter constant;
        constant.constant_power = true;
        in.site.transmitters.push_back(constant);
      }};
  std::set<std::string> hashes{Inputs().hash()};
  for (const auto& change : changes) {
    Inputs inputs;
    change(inputs);
    hashes.insert(inputs.hash());
  }
  EXPECT_EQ(hashes.size(), changes.size() + 1);
}

}  // namespace
}  // namespace rayloc::inputs_hash_test
