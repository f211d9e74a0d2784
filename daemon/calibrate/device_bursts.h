// What devices sent in recordings, in bursts, for calibrations without a survey.
#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "daemon/arguments/capture_argument.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/localizer.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

struct DeviceBursts {
  // Of one transmitter each, 200 ms, in the order in which they end; also of the fixed transmitters
  // whose place the site states.
  std::vector<std::vector<CsiFrame>> bursts;
  std::set<std::size_t> heard;  // access points
  bool is_any_device = false;   // or fixed transmitters alone
};

// `notes` as of for_each_frame().
Expected<DeviceBursts> read_device_bursts(const Site& site,
                                          const std::vector<CaptureArgument>& captures,
                                          std::vector<std::string>& notes);

// Of devices that the site does not list, in its room.
Expected<std::shared_ptr<const Localizer>> device_localizer(const Site& site, RoomModel room);

}  // namespace rayloc::cli
