// Frequency bands of IEEE 802.11.
#pragma once

namespace rayloc {

enum class WifiBand { k2GHz, k5GHz, k6GHz };

// The band of a channel's centre [Hz]. IEEE 802.11-2020, annex E, ends the band of 2.4 GHz below
// 2.5 GHz and that of 5 GHz at 5.925 GHz.
constexpr WifiBand band_of(double centre_hz) {
  constexpr double kEndOf2GHz = 2.5e9;
  constexpr double kEndOf5GHz = 5.925e9;
  return centre_hz < kEndOf2GHz   ? WifiBand::k2GHz
         : centre_hz < kEndOf5GHz ? WifiBand::k5GHz
                                  : WifiBand::k6GHz;
}

}  // namespace rayloc
