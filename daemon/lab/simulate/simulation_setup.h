// SimulationSetup: all inputs of simulate_recordings(), read and checked.
#pragma once

#include <optional>
#include <vector>

#include "daemon/lab/simulate/capture_simulator.h"
#include "daemon/lab/simulate/second_day.h"
#include "daemon/lab/simulate/simulate_recordings.h"
#include "daemon/lab/simulate/transmissions.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/channel/radio_channel.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct SimulationSetup {
  std::vector<RadioChannel> channels;  // hop channels of the device; empty: the site's
  std::vector<RoomModel> rooms;        // by channel; on the site's channel if there are none
  bool is_walk = false;
  std::vector<SimulatedPoint> test_points;
  CaptureOptions options;
  std::optional<SecondDay> day;
  LivedInRoom lived;  // on the simulated day
};

// Reports the scene's notes once the room is read. Errors: as in simulate_recordings(), before any
// file is written.
Expected<SimulationSetup> read_simulation_setup(const Site& site,
                                                const SimulationOptions& options,
                                                const SimulationObserver& observer);

}  // namespace rayloc
