#include "daemon/lab/recordings/fixed_frames.h"

#include <utility>

#include "daemon/lab/recordings/recorded_frames.h"

namespace rayloc {

Expected<std::map<MacAddress, std::vector<CsiFrame>>> read_fixed_frames(
    const Site& site,
    const std::vector<CaptureArgument>& captures,
    std::vector<std::string>& notes) {
  std::map<MacAddress, std::vector<CsiFrame>> found;
  for (const RecordingArgument& recording : recordings_of(captures)) {
    const auto keep = [&](CsiFrame&& frame) {
      if (find_fixed_transmitter(site, frame.transmitter) != nullptr) {
        found[frame.transmitter].push_back(std::move(frame));
      }
    };
    RAYLOC_TRY(for_each_frame(site, recording, keep, notes));
  }
  return found;
}

}  // namespace rayloc
