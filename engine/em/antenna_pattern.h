// Antenna patterns of the field, by name.
//
// Sources: half-wave dipole, Balanis, Antenna Theory, (4-84); dipole: the short dipole, sin(theta).
#pragma once

#include <optional>
#include <string_view>

namespace rayloc {

enum class AntennaPattern { kIsotropic, kDipole, kHalfWaveDipole };
enum class Polarization { kVertical, kHorizontal };  // V = theta^, H = phi^ of the antenna's frame

// Names of site.toml and the command line: "isotropic" ("iso"), "dipole", "half_wave_dipole"
// ("hw_dipole"); nothing for another name.
std::optional<AntennaPattern> parse_antenna_pattern(std::string_view name);
std::string_view to_string(AntennaPattern pattern);

}  // namespace rayloc
