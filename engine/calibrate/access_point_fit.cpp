#include "engine/calibrate/access_point_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/calibrate/chain_ripple.h"
#include "engine/observe/alignment.h"
#include "engine/room/ray.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kYawPrior = 1.0 * kDegree;  // [rad], of a survey with a compass or by eye
// [rad], chosen: the scan covers three of kYawPrior to either side.
constexpr double kYawStep = 1.0 * kDegree;
constexpr int kYawSteps = 3;  // on each side
// The tones of a point are not independent evidence on the model's errors; one point is.
constexpr double kAccessPointEvidence = 0.1;

// The maximum of a function over a list of values: scans the list and returns the vertex of the
// parabola through the best value and its neighbours, with its width.
template <typename Function>
Fitted<double> maximise(const std::vector<double>& values, double prior, const Function& function) {
  std::vector<double> height;
  height.reserve(values.size());
  for (const double value : values) {
    height.push_back(function(value));
  }
  const auto best =
      static_cast<std::size_t>(std::max_element(height.begin(), height.end()) - height.begin());
  Fitted<double> result{values[best], prior, 0.0};
  if (best == 0 || best + 1 == values.size()) {
    return result;
  }
  const double left = values[best] - values[best - 1];
  const double right = values[best + 1] - values[best];
  const double slope_left = (height[best] - height[best - 1]) / left;
  const double slope_right = (height[best + 1] - height[best]) / right;
  const double curvature = 2.0 * (slope_right - slope_left) / (left + right);
  if (curvature < 0.0) {
    const double slope = (slope_left * right + slope_right * left) / (left + right);
    result.value += std::clamp(-slope / curvature, -left, right);
    result.sigma = std::sqrt(-1.0 / curvature);
  }
  return result;
}

}  // namespace

AccessPointCalibrator::AccessPointCalibrator(const RoomModel& room,
                                             std::size_t access_point,
                                             std::vector<CalibrationSample> samples)
    : grid_(room.grid),
      access_point_(room.access_points.at(access_point)),
      model_(room.grid, access_point_.rx_chains.size()),
      given_(samples.size()) {
  const PathTracer tracer(room.scene, room.trace);
  const ReceiverTracer at_array = tracer.at(array_origin<Receiver>(access_point_.array));
  std::vector<Sample> traced(samples.size());
  parallel_for(samples.size(), 4, [&](std::size_t i) {
    RAYLOC_CHECK(samples[i].h.size() == access_point_.rx_chains.size() * grid_.size());
    const Transmitter device{
        {samples[i].position, {}, room.device.pattern, room.device.polarization}};
    traced[i].index = i;
    traced[i].h = std::move(samples[i].h);
    traced[i].survey_sigma = samples[i].survey_sigma;
    traced[i].rays = rays_of(at_array.trace(device), room, samples[i].position, kMaxRays);
  });
  for (Sample& sample : traced) {
    if (!sample.rays.empty()) {
      samples_.push_back(std::move(sample));
    }
  }
}

std::vector<Vec3d> AccessPointCalibrator::offsets(double yaw_offset) const {
  AntennaArray array = access_point_.array;
  array.pose.orientation.yaw += yaw_offset;
  return offsets_of(array);
}

ObservationModel::Place AccessPointCalibrator::place(const Sample& sample,
                                                     const std::vector<Vec3d>& offsets) const {
  return {sample.rays, offsets, 0.0, sample.survey_sigma};
}

ChainGains AccessPointCalibrator::principal_gains(const std::vector<Vec3d>& offsets,
                                                  const ModelError& error,
                                                  std::vector<double>* sigma,
                                                  const Part& part) const {
  ChainGains gains{grid_, access_point_.rx_chains, {}, access_point_.gains.coupling};
  std::vector<ArrayPair> pairs((samples_.size() - part.first + part.step - 1) / part.step);
  parallel_for(pairs.size(), 4, [&](std::size_t i) {
    const Sample& sample = samples_[part.first + i * part.step];
    pairs[i] = {sample.h, model_.expected(place(sample, offsets), error)};
    apply_coupling(gains, pairs[i].expected);
  });
  ChainRipple ripple = chain_ripple(Aligner(grid_), grid_, std::move(pairs));
  if (sigma != nullptr) {
    *sigma = std::move(ripple.sigma);
  }
  gains.gain = std::move(ripple.gain);
  return gains;
}

std::vector<ObservedArray> AccessPointCalibrator::observe(const ChainGains& gains) const {
  std::vector<ObservedArray> observed(samples_.size());
  parallel_for(samples_.size(), 4, [&](std::size_t i) {
    auto h = samples_[i].h;
    remove_gains(gains, h);
    observed[i] = model_.observe(h);
  });
  return observed;
}

double AccessPointCalibrator::log_likelihood(const std::vector<ObservedArray>& observed,
                                             const std::vector<Vec3d>& offsets,
                                             const ModelError& error) const {
  std::vector<double> each(samples_.size());
  parallel_for(samples_.size(), 4, [&](std::size_t i) {
    const PlaceModel at = model_.place(place(samples_[i], offsets), error);
    each[i] = ObservationModel::log_likelihood(at, observed[i]);
  });
  double sum = 0.0;
  for (const double value : each) {
    sum += value;
  }
  return sum;
}

void AccessPointCalibrator::fit_yaw(AccessPointFit& fit) const {
  std::vector<double> scan;
  for (int i = -kYawSteps; i <= kYawSteps; ++i) {
    scan.push_back(kYawStep * i);
  }
  const ModelError error = fit.error.value();
  fit.yaw_offset = maximise(scan, 0.0, [&](double yaw) {
    const auto rotated = offsets(yaw);
    const auto gains = principal_gains(rotated, error, nullptr, {});
    const double prior = yaw / kYawPrior;
    return kAccessPointEvidence * log_likelihood(observe(gains), rotated, error) -
           0.5 * prior * prior;
  });
  fit.gain_sigma.clear();
  fit.gains = principal_gains(offsets(fit.yaw_offset.value), error, &fit.gain_sigma, {});
}

void AccessPointCalibrator::fit_error(AccessPointFit& fit) const {
  const auto rotated = offsets(fit.yaw_offset.value);
  const auto observed = observe(fit.gains);
  fit.error = fit_model_error(
      [&](const ModelError& error) {
        return kAccessPointEvidence * log_likelihood(observed, rotated, error);
      },
      fit.error);
}

Expected<AccessPointFit> AccessPointCalibrator::start() const {
  if (samples_.size() < kMinSamples) {
    const std::size_t unreached = given_ - samples_.size();
    return bad_input(
        "access point " + access_point_.id + ": " + std::to_string(samples_.size()) +
        " calibration points can be used, at least " + std::to_string(kMinSamples) + " are needed" +
        (unreached > 0 ? "; no ray of the plan leads from it to " + std::to_string(unreached) +
                             " more: is the access point inside a wall or furniture?"
                       : std::string()));
  }
  AccessPointFit fit;
  fit.samples_used = samples_.size();
  fit.error = assumed_model_error();
  return fit;
}

Expected<AccessPointFit> AccessPointCalibrator::fit(ArrayFit array) const {
  auto fit = start();
  const int rounds = array == ArrayFit::kFitted ? 2 : 1;
  for (int round = 0; fit && round < rounds; ++round) {
    if (array == ArrayFit::kFitted) {
      fit_yaw(*fit);
    } else {
      principal_gains(offsets(0.0), fit->error.value(), &fit->gain_sigma, {});
      fit->gains = access_point_.gains;
    }
    fit_error(*fit);
  }
  return fit;
}

Expected<AccessPointFit> AccessPointCalibrator::fit_gains() const {
  auto fit = start();
  if (fit) {
    fit->gains = principal_gains(offsets(0.0), fit->error.value(), &fit->gain_sigma, {});
  }
  return fit;
}

std::vector<std::optional<double>> AccessPointCalibrator::correlations(
    const AccessPointFit* fit) const {
  const Aligner aligner(grid_);
  const auto rotated = offsets(fit != nullptr ? fit->yaw_offset.value : 0.0);
  const ModelError error = fit != nullptr ? fit->error.value() : ModelError{};
  std::vector<std::optional<double>> each(given_);
  parallel_for(samples_.size(), 4, [&](std::size_t i) {
    auto h = samples_[i].h;
    if (fit != nullptr) {
      remove_gains(fit->gains, h);
    }
    each[samples_[i].index] =
        aligner.align(model_.expected(place(samples_[i], rotated), error), h).correlation;
  });
  return each;
}

std::vector<std::optional<double>> AccessPointCalibrator::crossed_correlations(
    const std::vector<Vec3d>& offsets) const {
  std::vector<std::optional<double>> each(given_);
  // A count: the gains of one half of the points are tested on the other half.
  constexpr std::size_t kFolds = 2;
  if (samples_.size() / kFolds < kMinSamples) {
    return each;
  }
  const ModelError error = assumed_model_error().value();
  std::array<ChainGains, kFolds> gains;
  for (std::size_t half = 0; half < kFolds; ++half) {
    gains.at(half) = principal_gains(offsets, error, nullptr, {half, kFolds});
  }
  const Aligner aligner(grid_);
  parallel_for(samples_.size(), 4, [&](std::size_t i) {
    auto h = samples_[i].h;
    remove_gains(gains.at((i + 1) % kFolds), h);
    each[samples_[i].index] =
        aligner.align(model_.expected(place(samples_[i], offsets), error), h).correlation;
  });
  return each;
}

AccessPointCalibrator AccessPointCalibrator::at_carrier(double centre_hz) const {
  AccessPointCalibrator other = *this;
  other.grid_.centre_hz = centre_hz;
  other.model_ = ObservationModel(other.grid_, access_point_.rx_chains.size());
  return other;
}

double AccessPointCalibrator::correlation(const AccessPointFit* fit) const {
  double sum = 0.0;
  for (const auto& one : correlations(fit)) {
    sum += one.value_or(0.0);
  }
  return samples_.empty() ? 0.0 : sum / static_cast<double>(samples_.size());
}

}  // namespace rayloc
