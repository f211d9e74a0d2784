// PersonLikelihood: likelihood of a burst of one access point for a person in a small patch of the
// room (METHODS B5). In the coordinates of DelayBasis, with the empty room's array x0 of power 1
// and the person's rays z_p = a dH_p:
//
//   mu(P) = x0 + sum_p z_p
//   Sigma = sum_p (v + u_p) |z_p|^2 s_p s_p^H + w sum_q g_q g_q^H o K_q
//           + d |z|^2 R + n I / D + (sigma_T)^2 x0' x0'^H
//
// g_q are the rays of all antennas over the same surfaces (path_errors.h), u_p is the coherence
// that a ray loses between two sample places, and R is a diffuse exponential tail. The measurement
// is known up to a complex factor, profiled out in closed form as in ObservationModel, and a delay:
// the burst is aligned to the empty room, a few delays about that are tried, and x0', the change of
// x0 by a delay, covers those between.
//
// A patch has two representations: in detail, its sample places a fraction of a wavelength apart;
// as a whole, their mean and covariance, which decide whether the detail is evaluated.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/channel/ofdm_grid.h"
#include "engine/likelihood/delay_basis.h"
#include "engine/likelihood/gaussian/whitened_gaussian.h"
#include "engine/likelihood/lane_kernel.h"
#include "engine/observe/alignment.h"
#include "engine/person/other_people.h"
#include "engine/person/person_reference.h"
#include "engine/person/person_scattering.h"

namespace rayloc {

// A square patch of places and its samples of dH: count x count places, x outermost.
struct PatchPlan {
  double offset_x = 0.0;  // [m], of the patch's centre from where the rays were traced
  double offset_y = 0.0;
  double size = 0.05;  // [m]
  std::size_t count = 7;
  // [m], deviation of a place in the patch along each axis; 0: it may be anywhere in the patch.
  double known_to = 0.0;

  double place_sigma() const { return known_to > 0.0 ? known_to : size / std::sqrt(12.0); }
  double step() const { return size / static_cast<double>(count); }
  double at(std::size_t i) const {  // from the centre of the patch
    return (static_cast<double>(i) + 0.5) * step() - 0.5 * size;
  }
};

// dH over a patch, for a = 1.
struct ScatteredPatch {
  std::vector<std::complex<float>> sample;     // [place][coordinate]
  std::vector<std::complex<double>> strength;  // sum |z_p|^2 s_p s_p^H, lower triangle by rows
  std::vector<std::complex<double>> intra_cell_loss;  // the same times u_p
  std::vector<std::complex<double>> path_errors;      // sum g_q g_q^H o K_q
  std::vector<std::complex<double>> front;  // the same for power without phase (unknown front)
  double power = 0.0;                       // sum |z_p|^2
};

// One Gaussian.
struct PersonGaussian : WhitenedGaussian {
  double mean_power = 0.0;  // |W mu|^2
};

// A patch with the errors of a model.
struct PersonPlace {
  PersonGaussian whole;
  // Without the spread of the samples; the means are those of the sample places.
  WhitenedGaussian close;
  std::vector<float> mean_power;  // |W mu|^2 of each sample place

  std::span<const std::complex<float>> mean_of(std::size_t sample) const {
    const std::size_t size = close.mean.size() / mean_power.size();
    return std::span(close.mean).subspan(sample * size, size);
  }
};

// One of the sample places of a patch.
struct PersonCandidate {
  const PersonPlace* place = nullptr;
  std::size_t sample = 0;
};

class PersonLikelihood {
 public:
  // A count, chosen: 2 ns apart about the empty room's delay, 4 ns to either side.
  static constexpr std::size_t kDelays = 5;
  static_assert(kDelays <= kLaneCount);

  // A burst in the coordinates of the basis, aligned to the empty room, at some delays.
  struct Observed {
    std::array<std::vector<std::complex<double>>, kDelays> y;
    // The same in lanes, [coordinate][delay]; unused lanes repeat the last delay.
    std::vector<LaneRow> re;
    std::vector<LaneRow> im;
    double correlation = 0.0;  // with the empty room
    double noise = 0.0;        // share of its power that is noise within the basis
  };

  // `distance`: from the transmitter to the array's centre [m].
  PersonLikelihood(const OfdmGrid& grid,
                   std::size_t antennas,
                   const PersonLink& link,
                   double distance);

  std::size_t dimension() const { return empty_.size(); }

  // h: [rx_chain][tone], chain gains removed.
  Observed observe(std::span<const std::complex<double>> h) const;

  // `front_offset_sigma`: PersonModel::front_offset_sigma.
  ScatteredPatch patch(const ScatteredRays& rays,
                       const PatchPlan& plan,
                       double front_offset_sigma = 0.0) const;

  PersonPlace place(const ScatteredPatch& patch,
                    std::complex<double> scale,
                    const PersonModel& model) const;
  // Null model: the empty room.
  PersonGaussian no_person(const PersonModel& model) const;
  // The room with a change of unknown kind, by this share of its power.
  PersonGaussian changed(double share, const PersonModel& model) const;

  // People at these places, for the likelihood of one more.
  OtherPeople co_occupants(std::span<const PersonCandidate> people, const PersonModel& model) const;

  // Log-likelihoods, maximised over gain, phase and delay; up to a constant of the measurement.
  double log_likelihood(const PersonGaussian& gaussian,
                        const Observed& observed,
                        const OtherPeople& co_occupants = {}) const;
  // For every sample place. REQUIRES: out.size() == place.mean_power.size().
  void log_likelihood(const PersonPlace& place,
                      const Observed& observed,
                      const OtherPeople& co_occupants,
                      std::span<double> out) const;
  std::span<const std::complex<double>> empty() const { return empty_; }

  // Power that a person at a sample place adds; 1: as much as the empty room.
  double echo_power(const PersonCandidate& candidate) const;

  // Residual at a sample place, in units of the residual that its model expects: about 1.
  double misfit(const PersonCandidate& candidate,
                const Observed& observed,
                const OtherPeople& co_occupants = {}) const;

 private:
  struct PlaceEvaluation;
  class AccompaniedPlace;
  Eigen::VectorXcd echo_of(const PersonCandidate& candidate) const;
  WhitenedGaussian gaussian_of(std::vector<std::complex<double>> sigma,
                               const PersonModel& model) const;
  PersonGaussian gaussian_of(std::vector<std::complex<double>> sigma,
                             std::span<const std::complex<double>> mean,
                             const PersonModel& model) const;

  OfdmGrid grid_;
  std::size_t antennas_;
  double distance_;
  double wave_number_;  // [rad/m]
  double scale_ = 1.0;  // factor from a channel of the traced room to power 1
  DelayBasis basis_;
  Aligner aligner_;
  std::vector<std::complex<double>> reference_;  // H0, [rx_chain][tone]
  std::vector<std::complex<double>> empty_;      // x0
  std::vector<std::complex<double>> rotated_;    // x0' [1/s]
  std::vector<std::complex<double>> diffuse_;    // R of one antenna, [q][q]
};

}  // namespace rayloc
