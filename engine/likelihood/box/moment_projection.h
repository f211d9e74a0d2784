// MomentProjection: a burst of a few frames in the coordinates of DelayBasis at every delay of a
// search, as ObservationModel::observe(), in vectors of single precision. The coordinates differ by
// rounding, also between kinds of processors. If two delays of the search for the first one have
// the same power within rounding, the search may start at the other one.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"
#include "engine/likelihood/box/place_box.h"
#include "engine/likelihood/delay_basis.h"
#include "engine/likelihood/observed_array.h"

namespace rayloc {

class MomentProjection {
 public:
  // basis: of this grid. REQUIRES: 1 to kMaxBoxAntennas antennas.
  MomentProjection(const OfdmGrid& grid, const DelayBasis& basis, std::size_t antennas);

  // h: [antenna][tone], chain gains removed.
  ObservedArray observe(std::span<const std::complex<double>> h) const;

  // Numbers by tone in split form, padded with zeros to whole vectors.
  struct Tones {
    std::vector<float> re;
    std::vector<float> im;

    explicit Tones(std::size_t size = 0) : re(size), im(size) {}
  };
  struct Tables {
    std::size_t antennas = 0;
    std::size_t coordinates = 0;  // of one antenna
    std::size_t stride = 0;       // tones of a line, padded
    std::size_t delays = 0;       // of the search for the first one
    Tones basis;                  // [coordinate][tone]
    Tones to_next;                // [tone], from one of these delays to the next
    Tones step;                   // [tone], from one delay of ObservedArray to the next
  };

 private:
  OfdmGrid grid_;
  double delay_step_;  // [s], of the search for the first delay
  Tables tables_;
};

}  // namespace rayloc
