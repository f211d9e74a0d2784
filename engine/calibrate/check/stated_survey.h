// StatedSurvey: how well the recordings of a survey are explained as stated, and how well with
// another access point, another place, another array or another carrier.
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

// An alternative meaning of a recording.
struct Meant {
  std::size_t recorded = 0;                       // access point stated for it
  std::size_t pose = 0;                           // access point that made it
  std::function<Vec3d(std::size_t point)> place;  // device position; empty: as stated
  std::optional<AntennaArray> array;              // of `pose`; nullopt: as stated
};

// Correlations are crossed_correlations(), per point.
class StatedSurvey {
 public:
  // Traces every point. `room` and `points` must outlive it.
  StatedSurvey(const RoomModel& room, std::span<const CalibrationPoint> points);

  const RoomModel& room() const { return room_; }
  std::span<const CalibrationPoint> points() const { return points_; }
  // For each access point, as stated.
  const std::vector<Correlations>& stated() const { return stated_; }
  bool is_recorded(std::size_t access_point) const;
  // The same, each with gains fitted to all points: the reference with which every point is
  // compared to find misfitting ones.
  std::vector<PointFit> fits() const;

  Correlations other(const Meant& meant) const;
  // The same with every place exchanged for one half of the survey away: the correlation of
  // unrelated recordings and places, with gains fitted to them.
  Correlations by_chance(const Meant& meant) const;
  Correlations at_carrier(std::size_t access_point, double centre_hz) const;

 private:
  struct Received {
    std::vector<std::size_t> point;  // for each sample
    AccessPointCalibrator calibrator;
  };
  using Rows = std::function<std::vector<std::complex<double>>(std::size_t point)>;
  Received receive(const RoomModel& room,
                   std::size_t access_point,
                   const Rows& rows,
                   const std::function<Vec3d(std::size_t)>& place) const;
  Received receive_stated(const RoomModel& room, std::size_t access_point) const;
  Correlations of_points(const Received& received, const Correlations& samples) const;
  Correlations evaluated(const Received& received, const AntennaArray& array) const;
  Vec3d place(std::size_t point) const { return points_[point].position; }

  const RoomModel& room_;
  std::span<const CalibrationPoint> points_;
  std::vector<Received> received_;  // for each access point, as stated
  std::vector<Correlations> stated_;
};

}  // namespace rayloc
