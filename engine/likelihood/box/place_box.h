// PlaceBox: the likelihood terms of one access point for a device anywhere in a box of about 10 x
// 10 cm x 0.3 m: one covariance, and rays whose phases follow the place.
//
// The strongest rays keep their mean; of the others only the power is known. The image of each
// antenna is fixed over the box, so the length of a ray is exact at the first antenna. The length
// at the other antennas is to first order, or exact if the device is too close for that.
//
// A burst has noise of its own. A box is made for a class of it, so that boxes can be kept and
// shared, whatever the bursts are.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/likelihood/observation_model.h"
#include "engine/room/ray.h"

namespace rayloc {

// A count, chosen: with 16 the correlation with the exact likelihood falls from 0.985 to 0.977.
inline constexpr std::size_t kBoxRays = 24;
inline constexpr std::size_t kMaxBoxRays = kMaxRays;  // for tests against the exact likelihood
inline constexpr std::size_t kMaxBoxAntennas = 4;     // a count: antennas of an access point
inline constexpr std::size_t kMaxBoxDimension = 96;   // about 18 coordinates x 4 antennas
inline constexpr int kNoiseClasses = 7;        // a count, chosen: up to 256 times the model's
inline constexpr float kMaxSlopePhase = 1.2F;  // [rad]: short polynomials hold to 1e-4

// Class of a burst's noise n' for a model noise n: 0 below 0.2 n, then a factor of 4 apart:
// clamp(round(log4(n' / n)) + 2, 1, 6). REQUIRES: model_noise > 0.
int noise_class_of(double burst_noise, double model_noise);
// The noise added to the model's for that class: 0, n / 4, n, 4 n, ... 256 n.
double noise_of_class(int noise_class, double model_noise);

// One block of memory:
//   rays      [ray]{ image x y z [m], its square [m^2], phase [turns],
//                    then for each antenna but the first { rotation re im, slope x y z [rad/m] } }
//   means     [ray][coordinate of one antenna]{re, im}, c_p a_p s_p without any phase of a length
//   whitener  a triangle by rows {re, im}
//   middle    W mu of the middle, line of sight clear, [coordinate]{re, im}
// Phasor of ray p at the first antenna, `d` from the middle of the box: exp(-2 pi j (sqrt(square -
// 2 image d + d^2) / wavelength + phase)). At antenna m it is that times rotation_m exp(j slope_m
// d), with rotation_m = exp(-j k (l_m - l_0)) and slope_m = k (e_m - e_0). With has_wide_slopes
// each other antenna has { image x y z, its square, phase } in place of its rotation and slope.
class PlaceBox {
 public:
  struct Size {
    std::size_t rays = 0;
    std::size_t antennas = 0;
    std::size_t coordinates = 0;  // of one antenna
  };

  PlaceBox() = default;  // no ray reaches it
  explicit PlaceBox(const Size& size);

  bool is_reachable() const { return size_.rays > 0; }
  const Size& size() const { return size_; }
  std::size_t dimension() const { return size_.antennas * size_.coordinates; }
  std::size_t ray_floats() const { return kAntennaFloats * size_.antennas; }
  float* ray(std::size_t p) { return block_.data() + p * ray_floats(); }
  const float* ray(std::size_t p) const { return block_.data() + p * ray_floats(); }
  float* mean(std::size_t p) { return block_.data() + mean_at(p); }
  const float* mean(std::size_t p) const { return block_.data() + mean_at(p); }
  float* whitener() { return block_.data() + mean_at(size_.rays); }
  const float* whitener() const { return block_.data() + mean_at(size_.rays); }
  float* middle() { return block_.data() + block_.size() - 2 * dimension(); }
  const float* middle() const { return block_.data() + block_.size() - 2 * dimension(); }
  std::span<const float> block() const { return block_; }

  static constexpr std::size_t kAntennaFloats = 5;  // a count: of a ray at one antenna
  static std::size_t floats_of(const Size& size);

  float turns_per_metre = 0.0F;  // 1 / wavelength
  float log_determinant = 0.0F;
  bool has_direct = false;       // ray 0 may be obstructed
  bool has_wide_slopes = false;  // |slope d| may exceed kMaxSlopePhase at a corner

 private:
  std::size_t mean_at(std::size_t p) const {
    return size_.rays * ray_floats() + 2 * p * size_.coordinates;
  }

  Size size_;
  std::vector<float> block_;
};

struct BoxShape {
  Vec3d shift;  // [m], in plan, from the place to the middle of the box
  Vec3d half;   // [m], half of the box's sides
};
// place: rays of a device above a traced position, at the height of the box's middle, with the
// place distance as cell_size (ObservationModel::Place). error.noise: of the model and the class
// together. REQUIRES: at most kMaxBoxAntennas, kMaxBoxDimension and kMaxBoxRays.
PlaceBox place_box(const ObservationModel& model,
                   const ObservationModel::Place& place,
                   const ModelError& error,
                   const BoxShape& shape,
                   std::size_t most_rays = kBoxRays);

}  // namespace rayloc
