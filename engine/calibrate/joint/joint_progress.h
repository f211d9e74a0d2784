// JointProgress: what a joint calibration tells while it runs: the steps so far, how far it is, and
// whether it was asked to stop.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/calibrate/room_calibration.h"

namespace rayloc {

// The work is in parts that are counted as equals: each round, and the fit to all points at the
// end.
class JointProgress {
 public:
  // `points`: that are fitted; `steps`: that a part takes when nothing has to be done again.
  JointProgress(const CalibrationObserver& observer, std::size_t points, int steps)
      : observer_(observer), points_(points), steps_(steps) {}

  // Goes on after those of an earlier run.
  void continue_from(const std::vector<CalibrationStep>& history);
  void set_heldout(double correlation) { heldout_ = correlation; }

  // From 0 on; kJointRounds is the fit to all points.
  void begin_part(int part);
  // One step further in the part; more steps than expected leave it at its end.
  void advance();

  // Adds a step to the history; false: stop.
  bool tell(const char* stage, double loss);
  // Asks again, between trials that are no steps on the way.
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
