// StatedSurvey: how well the recordings of a survey are explained as stated, and how well if
// another access point, another place, another array or another carrier were meant.
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/calibrate/access_point_fit.h"
#include "engine/calibrate/check/paired_comparison.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

// What is meant by a recording, if it is not as stated.
struct Meant {
  std::size_t recorded = 0;                       // the access point that it was given for
  std::size_t pose = 0;                           // the one that made it
  std::function<Vec3d(std::size_t point)> place;  // where the device was; empty: as stated
  std::optional<AntennaArray> array;              // of `pose`; nothing: as stated
};

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

  Correlations other(const Meant& meant) const;
  // The same with every place exchanged for one half of the survey away: what recordings and places
  // that have nothing to do with each other reach, gains fitted to them all the same.
  Correlations by_chance(const Meant& meant) const;
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
