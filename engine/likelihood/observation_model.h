// ObservationModel: how likely an access point's burst is for a device at a place with known rays.
// METHODS B2, `partial`: part of each ray is known and part is not.
//
// In the coordinates of DelayBasis, with s_p the unit space-delay vector of ray p and a total power
// of 1:
//   mu    = sum_p c_p a_p s_p
//   Sigma = sum_p (1 - c_p^2 + u_p) |a_p|^2 s_p s_p^H + d R + n I / D
// c_p = exp(-sigma_p^2 / 2) is the remaining part of a ray's mean when its phase relative to the
// first ray is uncertain by sigma_p: surfaces are displaced (2 k sigma_s cos per reflection), the
// device may be anywhere in its cell of the grid, and a surveyed position has an error. u_p is the
// uncertainty of its strength, by number of reflections; d R a diffuse exponential tail, n the
// rest.
//
// The measurement has an unknown complex factor and an unknown delay: the factor is profiled out in
// closed form, the delay by a search over the delays of ObservedArray.
//
// n is the noise of bursts of a strong device. burst_noise.h adds the noise of weak bursts.
//
// A person, or an object that is not in the plan, may obstruct the line of sight: with a
// probability of kObstructed its mean is not in mu (the unknown part of its power stays). The
// likelihood of a place is the larger one of both cases.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/likelihood/delay_basis.h"
#include "engine/likelihood/observed_array.h"
#include "engine/likelihood/place_model.h"
#include "engine/observe/burst.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlaceMean;
struct PlaceMoments;

// Degree of knowledge of the rays. With v_p the unknown share of a ray's power, mu = sum sqrt(1 -
// v_p) a_p s_p: the limits of the partial model are v_p = 0 and v_p = 1 for all rays.
enum class PathKnowledge : std::uint8_t {
  kPartial,
  kFull,   // sigma_s = 0, u_p = 0: the correlation with the expected array
  kPower,  // c_p = 0, u_p = 0: independent of the rays' phases
};

// Power that is not traced, as a share of the traced power, for a first ray of this length [m].
double diffuse_share(const ModelError& error, double first_length);

// The best-fitting delay of ObservedArray.
std::size_t best_delay(const PlaceModel& place, const ObservedArray& observed);

class ObservationModel {
 public:
  ObservationModel(const OfdmGrid& grid,
                   std::size_t antennas,
                   PathKnowledge knowledge = PathKnowledge::kPartial);

  // cell_size: full width of the uncertainty of the position in x and in y [m]. survey_sigma: of a
  // surveyed point, standard deviation on each axis [m].
  struct Place {
    std::span<const Ray> rays;
    std::span<const Vec3d> element_offset;  // [m] from the array's centre, world axes
    double cell_size = 0.0;
    double survey_sigma = 0.0;
    double cell_height = 0.0;  // full width of the uncertainty in z [m]
  };
  PlaceModel place(const Place& place, const ModelError& error) const;
  // The device at one of several heights above one place: the mean and the covariance of the
  // mixture. If some height has no rays, the place has none.
  struct WeightedPlace {
    Place place;
    double weight = 1.0;  // probability; all weights add to 1
  };
  PlaceModel column(std::span<const WeightedPlace> heights, const ModelError& error) const;
  // The same for a single burst: Sigma includes its noise.
  PlaceModel place_of_burst(const Place& place,
                            const ModelError& error,
                            const ObservedArray& observed) const;

  // Known fraction of a ray's mean, unknown fraction of its power: c_p and 1 - c_p^2 + u_p.
  struct Parts {
    double known;
    double unknown;
  };
  // The ray terms of a place, for places nearby. REQUIRES: place.rays not empty.
  struct RayTerms {
    std::vector<Parts> parts;  // [ray]
    // a_p and the delay, with a total power of 1, without the phase of the length: [ray][coordinate
    // of one antenna].
    std::vector<std::complex<double>> tone;
    double first_length = 0.0;  // [m], of the ray that arrives first; the reference of phases
  };
  RayTerms ray_terms(const Place& place, const ModelError& error) const;
  // s: a_p s_p of a ray before the factor of its known part, [antenna][coordinate of one].
  void put_array(const Place& place,
                 const RayTerms& terms,
                 std::size_t p,
                 std::span<std::complex<double>> s) const;
  double wave_number() const { return wave_number_; }  // [rad/m]
  // Index of the ray that may be obstructed: the line of sight, if there are other rays and means
  // are partially known. Otherwise rays.size().
  std::size_t obstructable(std::span<const Ray> rays) const;

  // R of one antenna, for a tail with this decay [s]: [coordinate][coordinate].
  std::vector<std::complex<double>> diffuse_covariance(double decay) const;

  // Null model with a diffuse tail only: the reference for every place. The tail has the usual
  // decay, not that of this room, since a channel outside the model may come from any room.
  PlaceModel null_model(const ModelError& error) const;

  // h: [antenna][tone], chain gains removed.
  ObservedArray observe(std::span<const std::complex<double>> h) const;

  // Log-likelihood, maximised over gain, phase and delay; up to a constant of the measurement.
  static double log_likelihood(const PlaceModel& place, const ObservedArray& observed);
  // The same over every fourth delay: a lower bound, at half the cost.
  struct Coarse {
    double log_likelihood = 0.0;
    std::uint8_t windows = 0;  // a bit for each window of ObservedArray that may hold the best
  };
  static Coarse coarse(const PlaceModel& place, const ObservedArray& observed);
  // Over these windows: refines the result of coarse().
  static double log_likelihood(const PlaceModel& place,
                               const ObservedArray& observed,
                               std::uint8_t windows);

  // Logarithm of the odds that the line of sight is obstructed; empty if there is none.
  static std::optional<double> obstructed_log_odds(const PlaceModel& place,
                                                   const ObservedArray& observed);

  // The expected array at a place, [antenna][tone], without the unknown parts: for correlation.
  std::vector<std::complex<double>> expected(const Place& place, const ModelError& error) const;

  const DelayBasis& basis() const { return basis_; }
  std::size_t dimension() const { return antennas_ * basis_.size(); }

 private:
  Parts parts(const Ray& ray, const Ray& first, const Place& place, const ModelError& error) const;
  PlaceMean add_rays(const Place& place,
                     const ModelError& error,
                     double weight,
                     PlaceMoments& moments) const;
  double first_delay(std::span<const std::complex<double>> h) const;
  double coherence(const Ray& ray,
                   const Ray& first,
                   const Place& place,
                   const ModelError& error) const;

  OfdmGrid grid_;
  std::size_t antennas_;
  PathKnowledge knowledge_;
  double wave_number_;  // [rad/m], at the centre
  DelayBasis basis_;
  std::vector<std::vector<std::complex<double>>> diffuse_;  // R of one antenna, [decay][q][q]
};

}  // namespace rayloc
