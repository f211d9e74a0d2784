// FrameTable: frames of recordings, with the names of the access points to which they refer.
#pragma once

#include <string>
#include <vector>

#include "engine/channel/csi_frame.h"

namespace rayloc::python {

struct FrameTable {
  std::vector<CsiFrame> frames;
  std::vector<std::string> access_points;
  std::vector<std::string> notes;
};

}  // namespace rayloc::python
