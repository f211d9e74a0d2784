// JointCalibration: one run of calibrate_jointly() (joint_calibration.h).
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/constants.h"
#include "engine/base/expected.h"
#include "engine/calibrate/joint/joint_calibration.h"
#include "engine/calibrate/joint/joint_progress.h"
#include "engine/calibrate/joint/joint_rounds.h"
#include "engine/calibrate/joint/sample_model.h"
#include "engine/calibrate/point_uses.h"

namespace rayloc {

class JointCalibration {
 public:
  JointCalibration(const RoomModel& room,
                   std::span<const CalibrationPoint> points,
                   const JointCalibrationOptions& options,
                   const CalibrationObserver& observer);

  Expected<void> check() const { return check_uses(original_, points_, use_); }
  Expected<RoomCalibration> run();

 private:
  Expected<void> retrace();
  void measure();
  void weigh(const JointRound& round);
  std::vector<char> released(const JointRound& round) const;
  JointOptions joint_options(const JointRound& round, std::span<const char> released) const;
  JointContext context(std::span<const JointSample> samples) const {
    return {model_, unknowns_, samples, traced_at_};
  }
  double half_wave() const { return 0.5 * kSpeedOfLight / original_.grid.centre_hz; }  // [m]
  std::vector<double> change() const { return context({}).change(state_.values); }
  std::vector<ChainGains> gains() const;
  void set_gains(std::span<const ChainGains> gains);
  double correlation(std::size_t sample, const ModelPoint& at) const;
  double median_correlation(std::span<const Use> uses, std::span<const Vec3d> survey) const;
  double met(const JointRound& round, std::span<const Use> uses) const;
  bool solve(const JointRound& round, std::span<const Use> uses, const char* stage);
  bool settle(const JointRound& round);
  bool find_survey(const JointRound& round);
  bool search(const JointRound& round, bool cycles);
  Expected<double> go_from(const JointState& before,
                           double met_before,
                           const JointRound& round,
                           std::span<const Use> uses);
  Expected<bool> run_round(std::size_t index);
  Expected<void> go_back_to(const JointCheckpoint& reached);
  void checkpoint(JointCheckpoint& reached) const;
  Expected<double> finish(const JointRound& round);
  void fold_chains();
  std::vector<Vec3d> placed(const JointRound& round, std::span<const JointSample> samples) const;
  std::vector<JointSample> used(std::span<const Use> uses) const;
  std::vector<RoomParameter> parameters(const JointRound& round);

  RoomModel original_;               // its chain gains are improved
  std::vector<ChainGains> assumed_;  // initial chain gains
  std::span<const CalibrationPoint> points_;
  const JointCalibrationOptions& options_;
  RoomUnknowns unknowns_;
  SampleModel plain_;
  SampleModel model_;     // with weighted coordinates
  std::vector<Use> use_;  // for each point
  std::vector<SampleSite> sites_;
  JointState state_;
  std::vector<double> traced_at_;
  std::vector<TracedSample> traced_;
  std::vector<double> power_;  // surface_power()
  std::vector<MeasuredSample> measured_;
  std::vector<std::vector<std::complex<double>>> h_;  // for each sample, chain gains removed
  std::vector<WaveCycle> other_cycles_;
  double survey_sigma_;  // [m], of the points
  JointProgress progress_;
};

}  // namespace rayloc
