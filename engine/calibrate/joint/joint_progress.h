// JointProgress: progress reports of a running joint calibration: the steps so far, the share of
// work done, and any request to stop.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/calibrate/room_calibration.h"

namespace rayloc {

// The work is divided into parts of equal weight: each round, and the final fit to all
// points.
class JointProgress {
 public:
  // `points`: number that is fitted; `steps`: steps of a part if no step is repeated.
  JointProgress(const CalibrationObserver& observer, std::size_t points, int steps)
      : observer_(observer), points_(points), steps_(steps) {}

  // Continues after the steps of an earlier run.
  void continue_from(const std::vector<CalibrationStep>& history);
  void set_heldout(double correlation) { heldout_ = correlation; }

  // From 0 on; kJointRounds denotes the fit to all points.
  void begin_part(int part);
  // Advances by one step in the part; more steps than expected leave it at its end.
  void advance();

  // Adds a step to the history and reports it; false: stop.
  bool report(const char* stage, double loss);
  // Polls for a stop again, between trials that are not steps of the history.
  bool go_on();

  bool is_stopped() const { return stopped_; }
  const std::vector<CalibrationStep>& history() const { return history_; }

 private:
  const CalibrationObserver& observer_;
  std::size_t points_;
  int steps_;
  int part_ = 0;
  int done_ = 0;  // steps of the part
  std::vector<CalibrationStep> history_;
  double heldout_ = 0.0;
  bool stopped_ = false;
};

}  // namespace rayloc
