// ObservationModel: how likely an access point's burst is when the device stands at a place whose
// rays are known. METHODS B2, `partial`: of every ray a part is known and a part is not.
//
// In the coordinates of DelayBasis, with s_p the unit space-delay vector of ray p and power 1 in
// all:
//   mu    = sum_p c_p a_p s_p
//   Sigma = sum_p (1 - c_p^2 + u_p) |a_p|^2 s_p s_p^H + d R + n I / D
// c_p = exp(-sigma_p^2 / 2) is what is left of a ray's mean when its phase, relative to the first
// ray's, is uncertain by sigma_p: surfaces are displaced (2 k sigma_s cos per reflection), and the
// device may be anywhere in its cell of the grid, and a surveyed point is not where it is said to
// be. u_p is the uncertainty of its strength, by number of reflections; d R a diffuse exponential
// tail, n the rest.
//
// The measurement is known up to a complex factor and a delay: the factor is profiled out in closed
// form, the delay by a search over the delays of ObservedArray.
//
// n is what bursts of a strong device have. What a weak one has beside it is in burst_noise.h.
//
// Somebody may stand in the direct way, or something that the plan does not have: with a
// probability of kCovered its mean is not in mu (what is unknown of its power stays). A place is as
// likely as the better of both makes it.
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

// How much of a ray is known. With v_p the unknown share of its power, mu = sum sqrt(1 - v_p) a_p
// s_p: the limits of the partial model are v_p = 0 and v_p = 1 for all rays.
enum class PathKnowledge : std::uint8_t {
  kPartial,
  kFull,   // sigma_s = 0, u_p = 0: the correlation with what is expected
  kPower,  // c_p = 0, u_p = 0: nothing depends on the rays' phases
};

// Power of what is not traced, share of the traced, where the first ray is so long [m].
double diffuse_share(const ModelError& error, double first_length);

// The delay of ObservedArray that fits best.
std::size_t best_delay(const PlaceModel& place, const ObservedArray& observed);

class ObservationModel {
 public:
  ObservationModel(const OfdmGrid& grid,
                   std::size_t antennas,
                   PathKnowledge knowledge = PathKnowledge::kPartial);

  // cell_size: how far the device may be from the place in x and in y, full width [m].
  // survey_sigma: of a surveyed point, standard deviation on each axis [m].
  struct Place {
    std::span<const Ray> rays;
    std::span<const Vec3d> element_offset;  // [m] from the array's centre, world axes
    double cell_size = 0.0;
    double survey_sigma = 0.0;
    double cell_height = 0.0;  // how far in z, full width [m]
  };
  PlaceModel place(const Place& place, const ModelError& error) const;
  // The device at one of several heights above one place: the mean and the covariance of the
  // mixture. A place that a height has no rays to has none.
  struct WeightedPlace {
    Place place;
    double weight = 1.0;  // probability, 1 in all
  };
  PlaceModel column(std::span<const WeightedPlace> heights, const ModelError& error) const;
  // The same for one burst alone: Sigma has its noise.
  PlaceModel place_of_burst(const Place& place,
                            const ModelError& error,
                            const ObservedArray& observed) const;

  // Of a ray's mean what is known, and of its power what is not: c_p and 1 - c_p^2 + u_p.
  struct Parts {
    double known;
    double unknown;
  };
  // What a place is made of, for places nearby. REQUIRES: place.rays not empty.
  struct RayTerms {
    std::vector<Parts> parts;  // [ray]
    // a_p and the delay, power 1 in all, without the phase of the length:
    // [ray][coordinate of one antenna].
    std::vector<std::complex<double>> tone;
    double first_length = 0.0;  // [m], of the ray that arrives first; phases count from it
  };
  RayTerms ray_terms(const Place& place, const ModelError& error) const;
  double wave_number() const { return wave_number_; }  // [rad/m]
  // The ray that may be covered: the direct one, where there are others and means are known in
  // part. Else rays.size().
  std::size_t coverable(std::span<const Ray> rays) const;

  // R of one antenna, for a tail that decays so fast [s]: [coordinate][coordinate].
  std::vector<std::complex<double>> diffuse_covariance(double decay) const;

  // Nothing known but a diffuse tail: what every place is compared with. It lasts as long as usual,
  // not as long as in this room, for what is no channel of it may come from any.
  PlaceModel nowhere(const ModelError& error) const;

  // h: [antenna][tone], chain gains removed.
  ObservedArray observe(std::span<const std::complex<double>> h) const;

  // Log-likelihood, maximised over gain, phase and delay; up to a constant of the measurement.
  static double log_likelihood(const PlaceModel& place, const ObservedArray& observed);
  // The same over every fourth delay: a lower bound, at half of the cost.
  struct Coarse {
    double log_likelihood = 0.0;
    std::uint8_t windows = 0;  // a bit for each window of ObservedArray that may hold the best
  };
  static Coarse coarse(const PlaceModel& place, const ObservedArray& observed);
  // In these windows: what log_likelihood() adds to coarse().
  static double log_likelihood(const PlaceModel& place,
                               const ObservedArray& observed,
                               std::uint8_t windows);

  // Logarithm of the odds that the direct way is covered; nothing where it cannot be.
  static std::optional<double> covered_log_odds(const PlaceModel& place,
                                                const ObservedArray& observed);

  // The expected array at a place, [antenna][tone], without the unknown parts: for correlation.
  std::vector<std::complex<double>> expected(const Place& place, const ModelError& error) const;

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
