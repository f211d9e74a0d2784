// AntennaPattern: gain of an antenna as a function of direction, by name or as a table.
//
// Frame: dipoles lie along z; "tr38901" and tables point to +x (theta = 90 degrees, phi = 0).
//
// References:
//   [B] Balanis, Antenna Theory, (4-84) and (4-91): half-wave dipole, directivity 1.643.
//   [38.901] 3GPP TR 38.901 V17.0.0, table 7.3-1: one element, half-power beamwidths of 65 degrees,
//       8 dBi, at least -22 dBi.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "engine/em/antenna_gain_table.h"

namespace rayloc {

class AntennaPattern {
 public:
  enum Kind : std::uint8_t {
    kIsotropic,
    kDipole,  // short: sin(theta)
    kHalfWaveDipole,
    kTr38901,
    kTable,
  };

  // Implicit, so that AntennaPattern::kDipole is a pattern. REQUIRES: kind != kTable.
  AntennaPattern(Kind kind);  // NOLINT(google-explicit-constructor)
  // kTable. REQUIRES: table != nullptr.
  explicit AntennaPattern(std::shared_ptr<const AntennaGainTable> table);

  Kind kind() const { return kind_; }
  // REQUIRES: kind() == kTable.
  const AntennaGainTable& table() const { return *table_; }

  // Tables are equal when they are the same object.
  friend bool operator==(const AntennaPattern&, const AntennaPattern&) = default;

 private:
  Kind kind_;
  std::shared_ptr<const AntennaGainTable> table_;
};

enum class Polarization { kVertical, kHorizontal };  // V = theta^, H = phi^ of the antenna's frame

// Names in site.toml and on the command line.
inline constexpr std::array<std::string_view, 4> kAntennaPatternNames = {
    "half_wave_dipole", "dipole", "isotropic", "tr38901"};

// Accepts one of these names, or "hw_dipole" or "iso"; nothing for any other.
std::optional<AntennaPattern> parse_antenna_pattern(std::string_view name);
// "table" for a table.
std::string_view to_string(const AntennaPattern& pattern);

}  // namespace rayloc
