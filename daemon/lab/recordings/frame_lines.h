// A CSI frame as a line of text: JSON for scripts, or a summary for people.
#pragma once

#include <string>

#include "engine/channel/csi_frame.h"

namespace rayloc {

// One object without newline: time, ap, transmitter, format, phy, bandwidth_mhz, sequence,
// sequence_control, cores, streams, tones, power_dbm, complete, flags, and centre_hz if the format
// states the channel; with `values` also tone_index and csi [rx_chain][stream][tone][re, im].
std::string frame_json(const CsiFrame& frame, const std::string& access_point, bool values);

// Without newline.
std::string frame_text(const CsiFrame& frame, const std::string& access_point);

}  // namespace rayloc
