// Bursts of devices from recordings, for calibrations without a survey.
#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct DeviceBursts {
  // Each from one transmitter, 200 ms, ordered by end time; fixed
  // transmitters included if the site states their positions.
  std::vector<std::vector<CsiFrame>> bursts;
  std::set<std::size_t> receivers;  // access points that received bursts
  bool is_any_device = false;       // false: only fixed transmitters
};

// `notes` as in for_each_frame().
Expected<DeviceBursts> read_device_bursts(const Site& site,
                                          const std::vector<CaptureArgument>& captures,
                                          std::vector<std::string>& notes);

// A localizer for devices that the site does not list, in its room.
Expected<std::shared_ptr<const Localizer>> device_localizer(const Site& site, RoomModel room);

}  // namespace rayloc
