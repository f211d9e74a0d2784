// The engine's CsiFrame as the public message CsiFrame.
#pragma once

#include <string>

#include "engine/channel/csi_frame.h"
#include "rayloc/v1/csi.pb.h"

namespace rayloc {

// `transmitter`: its published name (TargetNames).
v1::CsiFrame csi_message(const CsiFrame& frame,
                         const std::string& access_point,
                         const std::string& transmitter);

}  // namespace rayloc
