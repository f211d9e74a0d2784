#include "capture/decode/chanspec.h"

namespace rayloc {

std::optional<RadioChannel> channel_of_chanspec(std::uint16_t chanspec) {
  constexpr unsigned kBand2GHz = 0;
  constexpr unsigned kBand5GHz = 3;
  constexpr unsigned kWidth20MHz = 2;  // each further value is twice as wide
  constexpr unsigned kWidth160MHz = 5;
  constexpr double kStep = 5e6;  // spacing of channel numbers [Hz], IEEE 802.11-2020
  const unsigned number = chanspec & 0xffU;
  const unsigned width = (chanspec >> 11U) & 7U;
  const unsigned band = chanspec >> 14U;
  if (width < kWidth20MHz || width > kWidth160MHz) {
    return std::nullopt;
  }
  const int bandwidth_mhz = 20 << (width - kWidth20MHz);
  if (band == kBand5GHz && number >= 34 && number <= 177) {
    return RadioChannel{5e9 + kStep * number, bandwidth_mhz};
  }
  // Channel 14 is outside the grid of the others.
  if (band == kBand2GHz && number >= 1 && number <= 13) {
    return RadioChannel{2.407e9 + kStep * number, bandwidth_mhz};
  }
  return std::nullopt;
}

}  // namespace rayloc
