// Unpacking of the CSI words that Broadcom radios write: one 32-bit little-endian word a tone.
//
//   kFloat12  bcm43684, bcm4366c0   29 sign  28-18 |re|  17 sign  16-6 |im|  5-0 exponent
//   kFloat9   bcm4358               22 sign  21-14 |re|  13 sign  12-5 |im|  4-0 exponent
//   kInt16    bcm4339, bcm43455c0   15-0 re  31-16 im, both two's complement
//
// A value is (-1)^sign magnitude 2^exponent, the exponent in two's complement and common to both
// parts; it is exact in a float. The scale is specific to the radio.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rayloc {

enum class CsiWords : std::uint8_t { kFloat12, kFloat9, kInt16 };

inline constexpr std::size_t kBytesPerWord = 4;

// REQUIRES: words.size() == 4 * out.size(). `words` need not be aligned.
void unpack_csi_words(CsiWords layout,
                      std::span<const std::byte> words,
                      std::span<std::complex<float>> out);

}  // namespace rayloc
