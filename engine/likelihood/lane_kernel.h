// LaneKernel: the sums that dominate the run time of a fix, eight at a time, with the widest
// vectors that the processor has for eight floats. The result does not depend on the number of
// threads; it differs by rounding between kinds of processors.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace rayloc {

// One number for each of eight places or delays.
inline constexpr std::size_t kLaneCount = 8;
using LaneRow = std::array<float, kLaneCount>;
struct LaneSums {
  LaneRow re{};
  LaneRow im{};
};

// x is [coordinate], `whitener` a lower triangle W by rows. Returns |W x|^2, and (W x)^H v for
// every vector v of `along`, [vector][coordinate].
// REQUIRES: re.size() == im.size(), along.size() == sums.size() * re.size().
LaneRow whiten(const std::complex<float>* whitener,
               std::span<const LaneRow> re,
               std::span<const LaneRow> im,
               std::span<const std::complex<float>> along,
               std::span<LaneSums> sums);

// Prefetches a triangle into the processor's caches while another one is in use: the triangles of
// all places of a room exceed the cache size.
void fetch(std::span<const std::complex<float>> whitener);
void fetch(std::span<const float> block);  // any block of memory

// 2 D ln r - r^2 a + 2 r |b| per lane at its maximum over r, with a = power > 0 and b = along.
LaneRow at_best_gain(const LaneRow& power, const LaneSums& along, std::size_t dimension);

// A term of add_rotated(): `mean`, rotated by a phasor of its own in each lane.
struct RotatedMean {
  std::complex<float> turn;                   // common factor ...
  const LaneSums* turns = nullptr;            // ... of these phasors
  const std::complex<float>* mean = nullptr;  // [coordinate]
};

// [coordinate] += the sum of the terms. REQUIRES: re.size() == im.size().
void add_rotated(std::span<const RotatedMean> terms, std::span<LaneRow> re, std::span<LaneRow> im);

}  // namespace rayloc
