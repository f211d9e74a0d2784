// FieldKernel: the sums of a RayField, eight numbers at a time, with the widest vectors that the
// processor has for eight floats. The result does not depend on the number of threads; it differs
// by rounding between kinds of processors.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/lane_kernel.h"

namespace rayloc {

inline constexpr std::size_t kFieldRays = 32;   // a count, chosen: maximum of rays of known phase
inline constexpr std::size_t kFieldDelays = 3;  // a count: maximum of delays of a burst

// A number for each ray; 0 for rays that do not exist.
struct RaySums {
  std::array<float, kFieldRays> re{};
  std::array<float, kFieldRays> im{};
};
// Number of blocks of eight rays, the last padded with zeros: kept fields have few of kFieldRays.
constexpr std::size_t ray_blocks(std::size_t rays) { return (rays + kLaneCount - 1) / kLaneCount; }

// L and D of L D L^T = T + n I, T a real tridiagonal matrix and n the noise of a coordinate.
struct Bidiagonal {
  std::vector<float> below;  // [coordinate], of L below the diagonal; the last is unused
  std::vector<float> scale;  // [coordinate], of D, one over its root
  float log_determinant = 0.0F;
};

// D^-1/2 L^-1 Q^H y, `turn` = Q^H by rows; y is [coordinate] in eight lanes. out: [coordinate].
void turn_and_whiten(std::span<const std::complex<float>> turn,
                     const Bidiagonal& of,
                     std::span<const LaneRow> re,
                     std::span<const LaneRow> im,
                     std::span<LaneSums> out);
// The same for rays that are already multiplied by Q^H, [coordinate][block of rays]. out:
// [coordinate]; rays beyond the blocks keep their numbers.
void whiten_rays(const Bidiagonal& of, std::span<const LaneSums> rays, std::span<RaySums> out);

// Likelihood terms of a burst for the places of a RayField.
struct FieldTerms {
  std::size_t rays = 0;
  bool has_direct = false;      // the first ray is a line of sight
  float log_obstructed = 0.0F;  // [nat], log probability that it is obstructed
  float dimension = 0.0F;       // of the measurement
  float less = 0.0F;            // ln |Sigma|
  std::size_t delays = 0;
  std::array<float, kFieldDelays> power_inverse{};  // 1 / |W y|^2
  std::array<float, kFieldDelays> log_power{};
  std::array<RaySums, kFieldDelays> along{};  // (W v_p)^H W y
  std::array<RaySums, kFieldRays> gram{};     // (W v_p)^H W v_q, [p]
};

// Fills `gram`; z: [coordinate], whitened.
void gram_of(std::span<const RaySums> z, FieldTerms& terms);
// (W v_p)^H x; x: [coordinate].
RaySums along_of(std::span<const RaySums> z, std::span<const std::complex<float>> x);

// Eight places in a row, described by the phasors of the rays there.
struct FieldRow {
  const LaneSums* by_x = nullptr;  // [block of rays]
  const LaneSums* by_z = nullptr;  // [block of rays]
  const LaneSums* by_y = nullptr;  // [ray], at the eight places
};
// Log-likelihoods over the first `delays` of the terms; out.size() == rows.size().
void field_rows(const FieldTerms& terms,
                std::size_t delays,
                std::span<const FieldRow> rows,
                std::span<LaneRow> out);

// Terms of each access point in the mass of a place: with x = t l - shift the product of (right e^x
// + quarter e^(x/4) + sixteenth e^(x/16) + wrong), less the product of the wrong.
struct FusedArray {
  std::span<const LaneRow> log_likelihood;  // [row]
  float exponent = 1.0F;
  float shift = 0.0F;
  float right = 1.0F;
  float quarter = 0.0F;
  float sixteenth = 0.0F;
  float wrong = 0.0F;
};
void fuse_rows(std::span<const FusedArray> arrays, std::span<LaneRow> mass);

}  // namespace rayloc
