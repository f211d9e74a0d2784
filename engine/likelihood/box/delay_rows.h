// DelayRows: a burst in single precision with all delays of the search side by side, for the
// comparison with the places of a box.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/likelihood/observed_array.h"

namespace rayloc {

struct DelayRows {
  using Row = std::array<float, ObservedArray::kDelays>;
  std::vector<Row> re;  // [coordinate][delay]
  std::vector<Row> im;
  float noise = 0.0F;  // as ModelError::noise, from the power outside the basis

  std::size_t coordinates() const { return re.size(); }
};

// `values`: complex numbers of the burst, antennas x tones. REQUIRES: values >
// observed.coordinates().
DelayRows delay_rows(const ObservedArray& observed, std::size_t values);

// Noise of a burst of unit power, as ModelError::noise, if all power outside the basis is noise:
// (1 - captured) D / (values - D), in [0, 1]. `coordinates`: D. REQUIRES: values > coordinates.
double noise_outside_basis(double captured, std::size_t coordinates, std::size_t values);

}  // namespace rayloc
