#include "daemon/methods/track_options.h"

#include <string>

#include "engine/track/track.h"

namespace rayloc {

TrackOptions track_options(const MethodOptions& options) {
  TrackOptions track;
  track.is_exhaustive = options.is_exhaustive;
  if (const auto* tracks = find_value<std::string>(options.values, kTracksSetting)) {
    track.uses_cloud = *tracks == kCloudTracks;
  }
  return track;
}

}  // namespace rayloc
