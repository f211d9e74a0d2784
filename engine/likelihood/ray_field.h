// RayField: expected observation of a device anywhere in a box (a cell of a room and a layer of
// heights), in the form that minimises the cost of an additional place.
//
// Over a box the strongest rays keep direction and strength, and their phases rotate: with t_p(x)
// the phasor of a ray, the same at all antennas, mu(x) = sum_p t_p(x) v_p. A place then needs
//
//   |W mu|^2 = t^H G t,   (W mu)^H W y = t^H g,   G = (W V)^H W V,   g = (W V)^H W y,
//
// which depend on the number of rays, not of antennas and tones. Weak rays, at most 1 % of the
// power unless there are too many, count as unknown in phase.
//
// Sigma without noise is Q T Q^H, T a real tridiagonal matrix: for a burst of any noise n it is T +
// n I, which two numbers per coordinate factorise. So all expensive terms are kept, whatever the
// bursts are.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/grid/lattice.h"
#include "engine/likelihood/field_kernel.h"
#include "engine/likelihood/observation_model.h"
#include "engine/likelihood/observed_array.h"

namespace rayloc {

// Covariance of a cell and a few layers of heights.
struct FieldCovariance {
  std::vector<std::complex<float>> turn;  // Q^H, by rows
  std::vector<double> diagonal;           // of T
  std::vector<double> beside;             // of T, beside the diagonal
  std::vector<std::size_t> known;         // rays; the ray that may be obstructed is the first
  bool has_direct = false;                // such a ray exists
};

// Places of a box: plan.count_y is a multiple of kLaneCount.
struct FieldLattice {
  Lattice plan;
  std::vector<double> heights;  // [m] above the centre of the layer

  std::size_t rows() const { return heights.size() * plan.size() / kLaneCount; }
};

struct RayField {
  std::size_t rays = 0;
  std::vector<LaneSums> known;  // Q^H v_p, [coordinate][block of rays]
  std::vector<LaneSums> by_x;   // [x][block of rays]
  std::vector<LaneSums> by_z;   // [height][block of rays]
  std::vector<LaneSums> by_y;   // [eight of y][ray]

  FieldRow row(std::size_t x, std::size_t y, std::size_t z) const {
    const std::size_t blocks = ray_blocks(rays);
    return {by_x.data() + x * blocks, by_z.data() + z * blocks, by_y.data() + y * rays};
  }
};

// place: centre of all boxes. REQUIRES: it has rays, kPartial or kFull knowledge.
FieldCovariance field_covariance(const ObservationModel& model,
                                 const ObservationModel::Place& place,
                                 const ModelError& error);
// place: centre of the box, with the same rays as those of the covariance.
RayField ray_field(const ObservationModel& model,
                   const FieldCovariance& covariance,
                   const ObservationModel::Place& place,
                   const ModelError& error,
                   const FieldLattice& lattice);

// A burst prepared for one covariance.
class FieldBurst {
 public:
  // noise: of the model and the burst together, as ModelError::noise.
  FieldBurst(const FieldCovariance& covariance, const ObservedArray& observed, double noise);

  // Terms of a box; the best delay is the first of the terms. It is searched for with the first box
  // requested: over a few layers the path lengths change by centimetres.
  FieldTerms terms(const RayField& field);

 private:
  void take(const ObservedArray::Block& block);
  std::size_t best_of(std::span<const RaySums> z, std::size_t rays) const;
  std::vector<std::complex<float>> delay(std::size_t t) const;

  const FieldCovariance& covariance_;
  const ObservedArray& observed_;
  Bidiagonal factor_;
  std::vector<LaneSums> burst_;                         // whitened, [coordinate]
  LaneRow power_{};                                     // of the burst
  std::vector<std::vector<std::complex<float>>> best_;  // compared delays; empty: not yet chosen
  FieldTerms of_delays_;                                // terms of these delays
};

}  // namespace rayloc
