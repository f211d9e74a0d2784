// Csi: a complex array of channel state information, one value per receive antenna, spatial stream
// and tone.
//
// Antenna order is receiver first, then transmitter (stream). The owner of the array keeps its grid
// beside it (CsiFrame::tone_index, OfdmGrid).
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace rayloc {

class Csi {
 public:
  Csi() = default;
  Csi(std::size_t antennas, std::size_t streams, std::size_t tones)
      : antennas_(antennas),
        streams_(streams),
        tones_(tones),
        values_(antennas * streams * tones) {}

  std::size_t antennas() const { return antennas_; }
  std::size_t streams() const { return streams_; }
  std::size_t tones() const { return tones_; }

  // The tones of one antenna and stream, ascending in frequency.
  std::span<std::complex<float>> row(std::size_t antenna, std::size_t stream) {
    return {values_.data() + (antenna * streams_ + stream) * tones_, tones_};
  }
  std::span<const std::complex<float>> row(std::size_t antenna, std::size_t stream) const {
    return {values_.data() + (antenna * streams_ + stream) * tones_, tones_};
  }
  // All values, [antenna][stream][tone].
  std::span<const std::complex<float>> values() const { return values_; }

 private:
  std::size_t antennas_ = 0;
  std::size_t streams_ = 0;
  std::size_t tones_ = 0;
  std::vector<std::complex<float>> values_;
};

}  // namespace rayloc
