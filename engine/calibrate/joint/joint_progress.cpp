#include "engine/calibrate/joint/joint_progress.h"

#include <algorithm>

#include "engine/calibrate/joint/joint_rounds.h"

namespace rayloc {

void JointProgress::continue_from(const std::vector<CalibrationStep>& history) {
  history_ = history;
}

void JointProgress::begin_part(int part) {
  part_ = part;
  done_ = 0;
}

void JointProgress::advance() { done_ = std::min(done_ + 1, steps_); }

bool JointProgress::report(const char* stage, double loss) {
  history_.push_back({stage, static_cast<int>(history_.size()), loss, heldout_});
  return go_on();
}

bool JointProgress::go_on() {
  const double share =
      (static_cast<double>(part_) + static_cast<double>(done_) / static_cast<double>(steps_)) /
      static_cast<double>(kJointRounds + 1);
  if (observer_ && !observer_({history_.back(), share, points_})) {
    stopped_ = true;
  }
  return !stopped_;
}

}  // namespace rayloc
