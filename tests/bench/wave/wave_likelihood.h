// WaveLikelihood: the partial likelihood (observation_model.h) with what else is traced: rays over
// edges among the rays, and the traced density of diffuse power beside or in place of the tail.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/likelihood/delay_basis.h"
#include "engine/likelihood/observation_model.h"
#include "engine/room/room_model.h"
#include "tests/bench/wave/wave_place.h"

namespace rayloc::bench {

// A variant of the likelihood of a WavePlace. The default is the product's.
struct WaveVariant {
  std::string name;
  // The share of the amplitude of rays over an edge; 0: none.
  double edge_amplitude = 0.0;
  bool edge_phase = true;  // known as that of a reflection is; false: only their power
  bool deeper = false;     // rays of one interaction more in place of those over an edge
  // The share of the diffuse power that the density has; the rest is the tail's.
  double traced_share = 0.0;
  std::size_t density = 0;  // which, of kDensities
  bool lingers = false;     // every echo has a tail of its own
  bool absolute = false;    // d is of the density's power at the place, not of the rays'
};

// One point as received by one access point.
struct WaveSample {
  WavePlace place;
  ObservedArray observed;
};

// The rays of a place for a variant, for any errors of the model.
struct PreparedPlace {
  std::vector<Ray> rays;     // those over edges are the last
  Eigen::MatrixXcd columns;  // of each ray, power 1 in all
};

class WaveLikelihood {
 public:
  // survey_sigma: of every point [m].
  WaveLikelihood(const OfdmGrid& grid, const RoomAccessPoint& access_point, double survey_sigma);

  PreparedPlace prepare(const WavePlace& place, const WaveVariant& variant) const;
  // `prepared`: of the place and the variant.
  PlaceModel model_of(const WavePlace& place,
                      const PreparedPlace& prepared,
                      const WaveVariant& variant,
                      const ModelError& error) const;
  const ObservationModel& model() const { return model_; }
  const std::vector<Vec3d>& offsets() const { return offsets_; }

 private:
  // Covariance of the density, trace about 1; the lower triangle and more.
  Eigen::MatrixXcd density_covariance(const DensityBins& bins,
                                      const WaveVariant& variant,
                                      double decay) const;

  ObservationModel model_;
  DelayBasis basis_;
  std::vector<Vec3d> offsets_;
  double survey_sigma_;
  std::vector<Eigen::MatrixXcd> tone_;  // s s^H of each bin's middle
};

}  // namespace rayloc::bench
