// LaneKernel: the sums that a fix spends its time on, eight at a time, by the widest vectors that
// the processor has for eight floats. The result does not depend on threads; between kinds of
// processors it differs by rounding.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace rayloc {

// A number for each of eight places or delays.
inline constexpr std::size_t kLaneCount = 8;
using LaneRow = std::array<float, kLaneCount>;
struct LaneSums {
  LaneRow re{};
  LaneRow im{};
};

// x is [coordinate], `whitener` a lower triangle W by rows. Gives |W x|^2, and (W x)^H v of every
// vector v of `along`, [vector][coordinate].
// REQUIRES: re.size() == im.size(), along.size() == sums.size() * re.size().
LaneRow whiten(const std::complex<float>* whitener,
               std::span<const LaneRow> re,
               std::span<const LaneRow> im,
               std::span<const std::complex<float>> along,
               std::span<LaneSums> sums);

// Brings a triangle into the processor's caches while another one is worked with: those of all
// places of a room are more than the caches hold.
void fetch(std::span<const std::complex<float>> whitener);

// Of every lane 2 D ln r - r^2 a + 2 r |b| at its maximum over r, with a = power > 0 and b = along.
LaneRow at_best_gain(const LaneRow& power, const LaneSums& along, std::size_t dimension);

// What is added up by add_turned(): `mean`, turned by a phasor of its own in each lane.
struct TurnedMean {
  std::complex<float> turn;                   // times ...
  const LaneSums* turns = nullptr;            // ... these
  const std::complex<float>* mean = nullptr;  // [coordinate]
};

// [coordinate] += the sum of them. REQUIRES: re.size() == im.size().
void add_turned(std::span<const TurnedMean> terms, std::span<LaneRow> re, std::span<LaneRow> im);

}  // namespace rayloc
