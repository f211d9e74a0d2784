// NearbyLikelihood: likelihood of one burst, with its derivative, at places within a few
// centimetres of a place with known rays.
//
// Each ray keeps its surfaces, so its image of every antenna stays in place: lengths and their
// derivatives are exact (Fermat: minus the unit direction to the image). Strengths, delays relative
// to the first ray and the covariance are those of the central place; the rest is
// ObservationModel's likelihood,
//
//   ll(x) = max over r, phase and delay of  2 D ln r - r^2 y^H S^-1 y + 2 r |mu(x)^H S^-1 y|
//                                           - mu(x)^H S^-1 mu(x) - ln |S|,
//   d ll  = 2 Re( dmu^H (r e y~ - mu~) ),   y~ = S^-1 y, mu~ = S^-1 mu, e = (y~^H mu) / |.|.
//
// With an obstructed line of sight mu has one ray less: d = sum_m t_m w_m, with t_m its phasor at
// antenna m and w_m whitened once, so that W (mu - d) costs three more products of W mu and no
// second whitening.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/grid/lattice.h"
#include "engine/likelihood/lane_kernel.h"
#include "engine/likelihood/observation_model.h"

namespace rayloc {

class NearbyLikelihood {
 public:
  // `model`: model of the central place with the place distance as cell_size (as `place`;
  // ObservationModel::Place). The arguments must outlive it. REQUIRES: model.reachable.
  NearbyLikelihood(const ObservationModel& observation_model,
                   const ObservationModel::Place& place,
                   const ModelError& error,
                   const PlaceModel& model,
                   const ObservedArray& observed);
  // The same with a model from ObservationModel::place_of_burst(), which it owns.
  NearbyLikelihood(const ObservationModel& observation_model,
                   const ObservationModel::Place& place,
                   const ModelError& error,
                   std::unique_ptr<const PlaceModel> model,
                   const ObservedArray& observed);

  // Recommended distance between places, as a share of the wavelength.
  static constexpr double kPlaceDistance = 0.125;
  // The same for heights: path lengths to the walls hardly change with them.
  static constexpr double kHeightDistance = 0.25;

  struct Slope {
    double value = 0.0;
    double by_x = 0.0;  // [1/m]
    double by_y = 0.0;
  };
  // At the best of the delays of ObservedArray, which is held when the place changes: no
  // interpolation between delays, so that value and derivative are consistent.
  Slope at(const Vec3d& moved) const;

  // Expected observation of a device at that place.
  PlaceModel model_at(const Vec3d& moved) const;

  // At all places of the lattice, [x][y], `raised` [m] above the centre: lengths to first order in
  // x and y, in single precision.
  std::vector<double> on(const Lattice& lattice, double raised = 0.0) const;
  // The same at several equally spaced heights, [height][x][y]: lengths are exact at the first, at
  // the last and half-way, quadratic in between.
  struct Heights {
    double first = 0.0;  // [m] above the centre
    double step = 0.0;
    std::size_t count = 1;
  };
  std::vector<double> on(const Lattice& lattice, const Heights& heights) const;

 private:
  struct Source {  // one ray at one antenna
    Vec3d image;   // [m], relative to the centre
    std::size_t antenna = 0;
    std::size_t mean = 0;  // index of its first coordinate in means_
  };
  struct Delay {
    std::vector<std::complex<double>> observed;  // W y
    double power = 0.0;                          // |W y|^2
  };

  // Phasors of the sources on a lattice, with rows padded to whole LaneRows.
  struct Turns {
    std::vector<std::complex<float>> by_x;  // [source][x], including the phasor of the first place
    std::vector<LaneSums> by_y;             // [source][row of lanes]
  };
  // Phasors of a source at the first place of a lattice and from place to place, and their rotation
  // from one height to the next; the first rotation changes with the height itself.
  struct Turning {
    std::complex<double> at, step_x, step_y;
    std::complex<double> raised, raised_again, raised_x, raised_y;
  };

  void keep_strongest(const ObservationModel::Place& place, std::span<const double> power);
  Turning turning_of(const Source& source, const Lattice& lattice, const Heights& heights) const;
  static void take_turns(const Lattice& lattice, std::vector<Turning>& turnings, Turns& turns);
  void values_on(const Lattice& lattice, const Turns& turns, std::span<double> values) const;
  struct Direct {                                       // the line of sight that may be obstructed
    std::vector<std::vector<std::complex<double>>> of;  // [antenna], w_m
    std::vector<std::complex<float>> observed;          // [delay][antenna], w_m^H W y
    std::vector<std::complex<float>> gram;              // [antenna][antenna], w_m^H w_n
  };
  struct Means {
    std::vector<std::complex<double>> value, by_x, by_y;  // W mu and its derivatives
  };

  void keep_direct(std::size_t ray);
  Means means_at(const Vec3d& moved, bool obstructed) const;
  Slope slope(const Means& means) const;
  LaneRow log_likelihoods(std::span<const LaneRow> re,
                          std::span<const LaneRow> im,
                          std::span<const LaneSums> direct) const;
  LaneRow best_of_delays(const LaneRow& power, std::span<const LaneSums> along) const;
  LaneRow obstructed_power(const LaneRow& power,
                           std::span<const LaneSums> along,
                           std::span<const LaneSums> direct) const;
  void take_direct(std::size_t k, std::span<const LaneSums> direct, LaneSums& along) const;

  std::unique_ptr<const PlaceModel> own_;  // null: model_ has another owner
  std::size_t size_;                       // D
  std::size_t coordinates_;                // per antenna
  double wave_number_;
  const PlaceModel& model_;
  double first_length_ = 0.0;
  std::vector<std::complex<double>> means_;  // [ray][coordinate of one antenna]
  std::vector<std::complex<float>> single_means_;
  std::vector<Source> sources_;    // antenna by antenna
  std::vector<Delay> delays_;      // around the best delay at the centre
  Direct direct_;                  // empty: no line of sight
  std::size_t direct_source_ = 0;  // index of its source within each antenna
  std::vector<std::complex<float>>
      observed_;  // Delay::observed, [delay][coordinate]; then Direct::of
};

}  // namespace rayloc
