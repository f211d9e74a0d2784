// fit_access_point: chain gains and yaw of an access point and the errors of its model, from bursts
// of a device at surveyed points; closed form except for a few one-dimensional scans (METHODS B4,
// step 1).
//
// The rays of each point come from the uncalibrated scene (the floor plan). A reflection's phase is
// then uncertain by more than a full cycle, but not systematically: over all points the products of
// measured and expected arrays have one principal direction, the gains.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/model_error_fit.h"
#include "engine/likelihood/observation_model.h"
#include "engine/observe/chain_gains.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A burst of a device at a surveyed point, as received by one access point.
struct CalibrationSample {
  Vec3d position;                       // [m]
  std::vector<std::complex<double>> h;  // [rx_chain][tone], BurstObservation::h
  // [m], standard deviation of the position on each axis. Its effect on rays is not an error of the
  // room's model: including it there would widen estimates by an error that does not occur in use.
  double survey_sigma = 0.0;
};

struct AccessPointFit {
  ChainGains gains;
  std::vector<double> gain_sigma;  // for each core, relative to the gain's magnitude
  Fitted<double> yaw_offset;       // [rad], to be added to the surveyed yaw
  FittedModelError error;
  std::size_t samples_used = 0;
};

// An access point's yaw and chain gains: fitted, or held at known values.
enum class ArrayFit : std::uint8_t { kFitted, kHeld };

// One access point of a room and the points used for its calibration.
class AccessPointCalibrator {
 public:
  // Traces the rays to every sample. `room` is the uncalibrated one; samples that no ray reaches
  // are not used. REQUIRES: every h has as many values as the access point has cores x tones.
  AccessPointCalibrator(const RoomModel& room,
                        std::size_t access_point,
                        std::vector<CalibrationSample> samples);

  // An Error when fewer than `kMinSamples` samples can be used.
  static constexpr std::size_t kMinSamples = 4;
  Expected<AccessPointFit> fit(ArrayFit array = ArrayFit::kFitted) const;
  // The gains alone, at the surveyed yaw and with the errors of a floor plan: without a scan, in a
  // tenth of the time.
  Expected<AccessPointFit> fit_gains() const;

  // Mean squared normalised correlation of measured and expected arrays over the samples: with the
  // gains and the yaw of a fit, or (nullptr) with equal gains and the surveyed yaw.
  double correlation(const AccessPointFit* fit) const;
  // The same for each given sample; nullopt where no ray reaches it.
  std::vector<std::optional<double>> correlations(const AccessPointFit* fit) const;
  // The same for each sample, with gains fitted without it: the gains of every second sample are
  // tested on the others. The elements are assumed at `offsets` [m] from the array's position,
  // world axes; the rays are those of the actual array. All nullopt where half of the samples are
  // fewer than kMinSamples.
  std::vector<std::optional<double>> crossed_correlations(const std::vector<Vec3d>& offsets) const;
  // A copy with another carrier: the rays are kept, their phases are those of the new wavelength.
  AccessPointCalibrator at_carrier(double centre_hz) const;

  std::size_t usable_samples() const { return samples_.size(); }

 private:
  struct Sample {
    std::size_t index = 0;  // in the given samples
    std::vector<std::complex<double>> h;
    std::vector<Ray> rays;
    double survey_sigma = 0.0;
  };

  Expected<AccessPointFit> start() const;
  std::vector<Vec3d> offsets(double yaw_offset) const;
  ObservationModel::Place place(const Sample& sample, const std::vector<Vec3d>& offsets) const;
  // Every `step`-th of the samples, from `first` on.
  struct Part {
    std::size_t first = 0;
    std::size_t step = 1;
  };
  ChainGains principal_gains(const std::vector<Vec3d>& offsets,
                             const ModelError& error,
                             std::vector<double>* sigma,
                             const Part& part) const;
  std::vector<ObservedArray> observe(const ChainGains& gains) const;
  double log_likelihood(const std::vector<ObservedArray>& observed,
                        const std::vector<Vec3d>& offsets,
                        const ModelError& error) const;
  void fit_yaw(AccessPointFit& fit) const;
  void fit_error(AccessPointFit& fit) const;

  OfdmGrid grid_;
  RoomAccessPoint access_point_;
  ObservationModel model_;
  std::vector<Sample> samples_;
  std::size_t given_ = 0;
};

}  // namespace rayloc
