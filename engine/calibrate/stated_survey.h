// StatedSurvey: how well the recordings of a survey are explained as stated, and how well if
// another access point, another place, another array or another carrier were meant.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/calibrate/access_point_fit.h"
#include "engine/calibrate/paired_comparison.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/localize/room_model.h"

namespace rayloc {

// Correlations are crossed_correlations(), of each point.
class StatedSurvey {
 public:
  // Traces every point. `room` and `points` outlive it.
  StatedSurvey(const RoomModel& room, std::span<const CalibrationPoint> points);

  const RoomModel& room() const { return room_; }
  std::span<const CalibrationPoint> points() const { return points_; }
  // Of each access point, as stated.
  const std::vector<Correlations>& stated() const { return stated_; }
  bool is_recorded(std::size_t access_point) const;
  // The same, each with gains of all points: those that every point is compared with to see whether
  // it stands alone.
  std::vector<PointFit> fits() const;

  // What was recorded as `access_point`'s, at places that the function says.
  Correlations at_places(std::size_t access_point,
                         const std::function<Vec3d(std::size_t)>& place) const;
  // What was recorded as that of one access point, as that of another.
  Correlations as_another(std::size_t recorded, std::size_t pose) const;
  Correlations with_array(std::size_t access_point, const AntennaArray& array) const;
  Correlations at_carrier(std::size_t access_point, double centre_hz) const;

 private:
  struct Heard {
    std::vector<std::size_t> point;  // of each sample
    AccessPointCalibrator calibrator;
  };
  using Rows = std::function<std::vector<std::complex<double>>(std::size_t point)>;
  Heard hear(const RoomModel& room,
             std::size_t access_point,
             const Rows& rows,
             const std::function<Vec3d(std::size_t)>& place) const;
  Heard hear_stated(const RoomModel& room, std::size_t access_point) const;
  Correlations of_points(const Heard& heard, const Correlations& samples) const;
  Correlations judged(const Heard& heard, const AntennaArray& array) const;
  Vec3d place(std::size_t point) const { return points_[point].position; }

  const RoomModel& room_;
  std::span<const CalibrationPoint> points_;
  std::vector<Heard> heard_;  // of each access point, as stated
  std::vector<Correlations> stated_;
};

}  // namespace rayloc
