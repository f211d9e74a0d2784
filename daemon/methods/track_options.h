// The setting "tracks" of method rayloc, and the options of its tracks.
#pragma once

#include <array>
#include <string_view>

#include "daemon/methods/method_options.h"

namespace rayloc {

struct TrackOptions;

inline constexpr std::string_view kTracksSetting = "tracks";
inline constexpr std::string_view kGridTracks = "grid";    // the default
inline constexpr std::string_view kCloudTracks = "cloud";  // of a confirmed track
inline constexpr std::array kTracksValues = {kGridTracks, kCloudTracks};

TrackOptions track_options(const MethodOptions& options);

}  // namespace rayloc
