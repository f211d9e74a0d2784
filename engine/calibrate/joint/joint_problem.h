// JointProblem: the robust least squares of the joint calibration (METHODS B4, steps 3 and 4), by
// Ceres: all unknowns of the room and the survey error of every point at once.
//
// The cost of a sample is kEvidence ln(floor + u) with u the share of the measured array that the
// model leaves unexplained: what no model of this kind explains (clutter, diffuse power) makes the
// floor, and a sample that fits nowhere pulls little. Priors are Gaussian. The survey errors are
// eliminated first (Schur complement).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/calibrate/joint/sample_model.h"

namespace rayloc {

// A sample's tones are no independent evidence: so many independent numbers does it count for.
inline constexpr double kEvidence = 6.0;

struct JointSample {
  const TracedSample* traced = nullptr;
  const MeasuredSample* measured = nullptr;
};

// What a fit is about. References stay.
struct JointContext {
  const SampleModel& model;
  const RoomUnknowns& unknowns;
  std::span<const JointSample> samples;
  std::span<const double> traced_at;  // values of the unknowns where the rays were traced

  // Of each unknown against where the rays were traced, for ModelPoint.
  std::vector<double> change(std::span<const double> values) const;
};

struct JointState {
  std::vector<double> values;  // of each unknown, against the original room
  std::vector<Vec3d> survey;   // [m], error of each point
};
// A share of the way from one to the other.
JointState between(const JointState& from, const JointState& to, double share);

struct JointOptions {
  double floor = 0.05;
  int iterations = 10;
  double survey_sigma = 0.005;     // [m]; 0: points stand where they were surveyed
  std::span<const char> released;  // of each unknown
};

// Mean share of the measured arrays that the model leaves unexplained, whatever the floor: what
// rounds compare by.
double mean_unexplained(const JointContext& context, const JointState& state);

// After each iteration: mean_unexplained(); false stops.
using JointObserver = std::function<bool(double unexplained)>;

class JointProblem {
 public:
  explicit JointProblem(const JointContext& context) : context_(context) {}

  // Improves `state`; returns the cost that is reached.
  double solve(const JointOptions& options, JointState& state, const JointObserver& observer) const;

  // Of `state`, the priors of what is released included.
  double cost(const JointOptions& options, const JointState& state) const;

  // Posterior standard deviation of every released unknown, 0 for the others: of the Gaussian about
  // `state`, the survey errors integrated out.
  std::vector<double> posterior(const JointOptions& options, const JointState& state) const;

  // [m], on each axis: how exact the survey is, by the survey errors of `state`; what the room can
  // take of them is not counted. `state` is of options.survey_sigma, so it is fitted and asked
  // again where the answer is far from that. REQUIRES: options.survey_sigma > 0.
  double survey_sigma(const JointOptions& options, const JointState& state) const;

 private:
  JointContext context_;
};

}  // namespace rayloc
