// JointProblem: the robust least squares of the joint calibration (METHODS B4, steps 3 and 4), with
// Ceres: all unknowns of the room and the survey error of every point at once.
//
// The cost of a sample is kEvidence ln(floor + u), where u is the share of the measured array that
// the model leaves unexplained. Power that no model of this kind explains (clutter, diffuse power)
// sets the floor, and a sample that fits no state of the room has little influence. Priors are
// Gaussian. The survey errors are eliminated first (Schur complement).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/calibrate/joint/sample_model.h"

namespace rayloc {

// A sample's tones are not independent evidence: it counts as this many independent numbers.
inline constexpr double kEvidence = 6.0;

struct JointSample {
  const TracedSample* traced = nullptr;
  const MeasuredSample* measured = nullptr;
};

// Inputs of a fit. The referenced objects must outlive it.
struct JointContext {
  const SampleModel& model;
  const RoomUnknowns& unknowns;
  std::span<const JointSample> samples;
  std::span<const double> traced_at;  // values of the unknowns where the rays were traced

  // Change of each unknown relative to the traced state, for ModelPoint.
  std::vector<double> change(std::span<const double> values) const;
};

struct JointState {
  std::vector<double> values;  // of each unknown, relative to the original room
  std::vector<Vec3d> survey;   // [m], error of each point
};
// Linear interpolation between two states by `share`.
JointState between(const JointState& from, const JointState& to, double share);

struct JointOptions {
  double floor = 0.05;
  int iterations = 10;
  double survey_sigma = 0.005;     // [m]; 0: points are exactly as surveyed
  std::span<const char> released;  // for each unknown
};

// Mean share of the measured arrays that the model leaves unexplained, independent of the floor:
// the measure by which rounds are compared.
double mean_unexplained(const JointContext& context, const JointState& state);

// Called after each iteration with mean_unexplained(); false stops.
using JointObserver = std::function<bool(double unexplained)>;

class JointProblem {
 public:
  explicit JointProblem(const JointContext& context) : context_(context) {}

  // Improves `state`; returns the final cost.
  double solve(const JointOptions& options, JointState& state, const JointObserver& observer) const;

  // Cost of `state`, including the priors of the released unknowns.
  double cost(const JointOptions& options, const JointState& state) const;

  // Posterior standard deviation of every released unknown, 0 for the others: of the Gaussian about
  // `state`, the survey errors integrated out.
  std::vector<double> posterior(const JointOptions& options, const JointState& state) const;

  // [m], on each axis: accuracy of the survey, estimated from the survey errors of `state`; errors
  // that the room can absorb are not counted. `state` depends on options.survey_sigma, so a caller
  // refits and calls again if the result is far from it. REQUIRES: options.survey_sigma > 0.
  double survey_sigma(const JointOptions& options, const JointState& state) const;

 private:
  JointContext context_;
};

}  // namespace rayloc
