// OfdmGrid: the frequencies at which a channel is measured or simulated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayloc {

// f_j = centre_hz + tone_index[j] * spacing_hz; tone_index ascending, 0 is the channel's centre.
struct OfdmGrid {
  double centre_hz = 0.0;
  double spacing_hz = 312'500.0;
  std::vector<std::int16_t> tone_index;

  std::size_t size() const { return tone_index.size(); }
  double frequency_hz(std::size_t j) const { return centre_hz + offset_hz(j); }
  double offset_hz(std::size_t j) const { return spacing_hz * tone_index[j]; }

  friend bool operator==(const OfdmGrid&, const OfdmGrid&) = default;
};

}  // namespace rayloc
