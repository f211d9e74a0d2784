// The plan of a closet of 3 x 2.4 x 2.5 m, in the format of `rayloc scene room`, for tests of verbs
// and of the pipeline on output of `rayloc simulate`. It is small, so calibration takes seconds.
#pragma once

#include <array>
#include <string>

namespace rayloc::test {

// Three antennas 8.9 cm apart, as an RT-AX86U numbers and spaces them.
// position: "[x, y, z]", metres.
inline std::string closet_access_point(const std::string& id,
                                       const std::string& position,
                                       int yaw_deg) {
  std::string text = "[[access_point]]\nid = \"" + id + "\"\nposition = " + position +
                     "\nyaw_deg = " + std::to_string(yaw_deg) +
                     "\npattern = \"half_wave_dipole\"\n";
  const std::array<std::string, 3> offsets = {"[0, -0.089, 0]", "[0, 0, 0]", "[0, 0.089, 0]"};
  const std::array<int, 3> rx_chains = {2, 0, 3};
  for (std::size_t i = 0; i < 3; ++i) {
    text += "[[access_point.antenna]]\ncore = " + std::to_string(rx_chains[i]) +
            "\noffset = " + offsets[i] + "\n";
  }
  return text;
}

// Has no access points: they and other tables may be appended.
inline constexpr const char* kCloset = R"(name = "closet"
size = [3.0, 2.4, 2.5]
corner = [-1.5, -1.2, 0]
floor = "concrete"
ceiling = "ceiling_board"
walls = "brick"
[carrier]
channel = 36
bandwidth_mhz = 40
centre_hz = 5190000000
tones = 128
active = [[-58, -2], [2, 58]]
)";

// The plan with "ap1" in a corner.
inline std::string closet_plan() {
  return kCloset + closet_access_point("ap1", "[-1.3, 1.0, 1.2]", -38);
}

}  // namespace rayloc::test
