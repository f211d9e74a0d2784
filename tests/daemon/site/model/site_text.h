// A complete site.toml for tests, and ways to change it: line numbers stay those of the text.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "daemon/site/model/site.h"
#include "tests/support/edited_text.h"
#include "tests/support/test_paths.h"

namespace rayloc::testing {

// The site of tests/data/sites/meeting_room with one access point; scene.xml is there.
inline const std::filesystem::path kSiteFile =
    std::filesystem::path(test::data_path()) / "sites" / "meeting_room" / "site.toml";

inline constexpr std::string_view kSiteText = R"(name = "meeting_room"
scene = "scene.xml"
[bounds]
x = [-1.765, 1.765]
y = [-1.425, 1.425]
z = [0, 2.7]
[carrier]
channel = 36
bandwidth_mhz = 40
centre_hz = 5190000000
tones = 128
tone_spacing_hz = 312500
active = [[-58, -2], [2, 58]]
[[access_point]]
id = "ap1"
format = "axcsi-v4"
position = [-1.4, 1.05, 1.2]
yaw_deg = -37
pitch_deg = 0
roll_deg = 0
pattern = "half_wave_dipole"
polarization = "V"
[[access_point.antenna]]
core = 2
offset = [0, -0.089, 0]
[[access_point.antenna]]
core = 0
offset = [0, 0, 0]
[[transmitter]]
role = "device"
mac = "02:52:4c:00:00:01"
height_m = 1.1
[[transmitter]]
role = "fixed"
mac = "02:52:4c:00:00:02"
position = [1.25, -0.45, 1.2]
[person]
radius_m = 0.165
height_m = 1.7
area_centre = [-0.07, 0.3]
area_radius_m = 4.5
[materials.glass]
thickness_m = 0.004
[georeference]
latitude = 49.87
longitude = 8.65
rotation_deg = 90
[[zone]]
name = "desk"
polygon = [[0, 0], [1, 0], [1, 1]]
[targets]
unlisted = "ignore"
)";

// kSiteText with the first `from` replaced by `to`.
inline std::string site_text(std::string_view from = "", std::string_view to = "") {
  return edited_text(std::string(kSiteText), from, to);
}

// The errors of a text, the folder taken from each line: "site.toml:3:1: ...".
inline std::string errors_of(std::string_view text) {
  const Expected<Site> site = parse_site(text, kSiteFile);
  return site ? "" : without_folder(site.error().message, kSiteFile);
}

}  // namespace rayloc::testing
