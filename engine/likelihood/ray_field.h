// RayField: what a device anywhere in a box, a cell of a room and a layer of heights, would let be
// heard, in the form in which one place more costs least.
//
// Over a box the strongest rays keep direction and strength, and their phases turn: with t_p(x) the
// phasor of a ray, the same at all antennas, mu(x) = sum_p t_p(x) v_p. A place is then worth
//
//   |W mu|^2 = t^H G t,   (W mu)^H W y = t^H g,   G = (W V)^H W V,   g = (W V)^H W y,
//
// numbers of the rays, whatever the antennas and tones are. Weak rays, which are 1 % of the power
// at most unless there are too many, count as unknown in phase.
//
// Sigma without noise is Q T Q^H, T a real tridiagonal matrix: that of a burst of any noise n is
// T + n I, which two numbers a coordinate factorise. So everything that costs is kept, whatever
// the bursts are.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/field_kernel.h"
#include "engine/likelihood/observation_model.h"
#include "engine/likelihood/observed_array.h"
#include "engine/room/lattice.h"

namespace rayloc {

// Of a cell and a few layers of heights.
struct FieldCovariance {
  std::vector<std::complex<float>> turn;  // Q^H, by rows
  std::vector<double> diagonal;           // of T
  std::vector<double> beside;             // of T, beside the diagonal
  std::vector<std::size_t> known;         // rays; the one that may be covered is the first
  bool has_direct = false;                // there is one
};

// The places of a box: plan.count_y is a multiple of kLaneCount.
struct FieldLattice {
  Lattice plan;
  std::vector<double> heights;  // [m] above the middle of the layer

  std::size_t rows() const { return heights.size() * plan.size() / kLaneCount; }
};

struct RayField {
  std::size_t rays = 0;
  std::vector<RaySums> known;  // Q^H v_p, [coordinate]
  std::vector<RaySums> by_x;   // [x]
  std::vector<RaySums> by_z;   // [height]
  std::vector<LaneSums> by_y;  // [eight of y][ray]

  FieldRow row(std::size_t x, std::size_t y, std::size_t z) const {
    return {by_x.data() + x, by_z.data() + z, by_y.data() + y * rays};
  }
};

// place: of the middle of all. REQUIRES: it has rays, kPartial or kFull knowledge.
FieldCovariance field_covariance(const ObservationModel& model,
                                 const ObservationModel::Place& place,
                                 const ModelError& error);
// place: of the middle of the box, the same rays as those of the covariance.
RayField ray_field(const ObservationModel& model,
                   const FieldCovariance& covariance,
                   const ObservationModel::Place& place,
                   const ModelError& error,
                   const FieldLattice& lattice);

// A burst beside a covariance.
class FieldBurst {
 public:
  // noise: of the model and the burst together, as ModelError::noise.
  FieldBurst(const FieldCovariance& covariance, const ObservedArray& observed, double noise);

  // Of a box; the best delay is the first of the terms. It is looked for with the first box that
  // is asked for: over a few layers the ways change by centimetres.
  FieldTerms terms(const RayField& field);

 private:
  void take(const ObservedArray::Block& block);
  std::size_t best_of(std::span<const RaySums> z, std::size_t rays) const;
  std::vector<std::complex<float>> delay(std::size_t t) const;

  const FieldCovariance& covariance_;
  const ObservedArray& observed_;
  Bidiagonal factor_;
  std::vector<LaneSums> burst_;                         // whitened, [coordinate]
  LaneRow power_{};                                     // of it
  std::vector<std::vector<std::complex<float>>> best_;  // the delays that are compared; empty: none
  FieldTerms of_delays_;                                // what terms have of these
};

}  // namespace rayloc
