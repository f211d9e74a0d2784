// LocationEstimate: a target's position with its uncertainty, or the reason for having none.
//
// World coordinates of the room, metres. A covariance is 3 x 3, row-major; its z entries are those
// of the assumed height where the height is not estimated.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"

namespace rayloc {

struct Hypothesis {
  Vec3d position;
  std::array<double, 9> covariance{};
  double weight = 0.0;  // probability
};

struct LocationEstimate {
  // Absent: NO_FIX, and `reason` states why. Never a sentinel.
  std::optional<Vec3d> position;
  std::string reason;

  // False for a method that has no error model for its position: then the next three fields are
  // meaningless, and there are no hypotheses.
  bool is_uncertainty_stated = true;
  // Covariance of the whole posterior about `position`; meaningless without a position.
  std::array<double, 9> covariance{};
  bool is_height_estimated = false;   // false: z is the assumed height
  double accuracy_m = 0.0;            // horizontal radius that contains the target ...
  double accuracy_confidence = 0.95;  // ... with this probability

  std::vector<Hypothesis> hypotheses;  // heaviest first, at most LocalizerOptions::max_hypotheses
  double residual_probability = 1.0;   // 1 - sum of the weights: any other position
  bool ambiguous = false;              // a hypothesis at another position is nearly as likely

  // Negative log-likelihood of `position`, up to a constant of the site, or another quantity that
  // the method minimises.
  double loss = 0.0;
  double snr_db = 0.0;  // of one frame, median over the access points
  // Power that the model at `position` leaves unexplained; absent where it is not computed.
  std::optional<double> model_residual_db;

  std::size_t iterations = 0;  // steps that led to `position`; 0: none in this method
  std::size_t starts = 0;      // number of starting positions; 0: none in this method
  std::size_t frames_used = 0;
  std::size_t access_points_used = 0;
  std::size_t antennas_used = 0;
  std::vector<std::string> warnings;

  Timestamp time;           // middle of the first and the last frame used
  Timestamp capture_start;  // first frame of the burst
  Timestamp capture_end;    // last frame of the burst
};

}  // namespace rayloc
