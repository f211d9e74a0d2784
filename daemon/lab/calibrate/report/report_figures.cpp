#include "daemon/lab/calibrate/report/report_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "daemon/lab/calibrate/report/fit_summary.h"
#include "daemon/lab/draw/chart.h"
#include "daemon/lab/draw/room_map.h"
#include "daemon/site/plan/palette.h"
#include "engine/base/check.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

using draw::Chart;
using draw::ChartCurve;
using draw::Drawing;

constexpr double kMillimetre = 1e-3;  // [m]

std::vector<draw::MapAntenna> antennas_of(const RoomModel& room) {
  std::vector<draw::MapAntenna> antennas;
  for (const RoomAccessPoint& ap : room.access_points) {
    antennas.push_back({ap.id, ap.array.pose.position});
  }
  return antennas;
}

// Base line of an upright surface on the plan: its corners furthest apart along its foot.
std::pair<Vec3d, Vec3d> foot_of(const Surface& surface) {
  const Vec3d& normal = surface.plane().normal;
  const Vec3d along{-normal.y, normal.x, 0.0};
  const auto& corners = surface.outline();
  const auto ends =
      std::minmax_element(corners.begin(), corners.end(), [&](const Vec3d& a, const Vec3d& b) {
        return dot(along, a) < dot(along, b);
      });
  return {*ends.first, *ends.second};
}

}  // namespace

Drawing draw_loss(const CalibrationMethodResult& result) {
  ChartCurve curve{"points that are fitted", {}, draw::curve_colour(0), false};
  std::vector<double> losses;
  for (const CalibrationStep& step : result.calibration.history) {
    curve.points.push_back({static_cast<double>(step.iteration), step.loss});
    losses.push_back(step.loss);
  }
  Chart chart;
  chart.title = "Loss, method " + result.method;
  chart.x.label = "iteration";
  chart.y.label = "loss";
  chart.y.scale = draw::suitable_scale(losses);
  chart.curves.push_back(std::move(curve));
  return draw_chart(chart);
}

Drawing draw_heldout_history(const CalibrationReport& report) {
  Chart chart;
  chart.title = "Points held out";
  chart.x.label = "iteration";
  chart.y = {"median correlation", draw::AxisScale::kLinear, 0.0, 1.0};
  for (std::size_t i = 0; i < report.methods.size(); ++i) {
    ChartCurve curve{report.methods[i].method, {}, draw::curve_colour(i), false};
    for (const CalibrationStep& step : report.methods[i].calibration.history) {
      curve.points.push_back({static_cast<double>(step.iteration), step.heldout});
    }
    chart.curves.push_back(std::move(curve));
  }
  return draw_chart(chart);
}

Drawing draw_fit_distribution(const CalibrationReport& report, std::size_t access_point) {
  Chart chart;
  chart.title = "Points held out, " + report.access_points.at(access_point);
  chart.x = {"correlation", draw::AxisScale::kLinear, 0.0, 1.0};
  chart.y = {"share of the points", draw::AxisScale::kLinear, 0.0, 1.0};
  const auto add = [&](const std::string& name,
                       const RoomCalibration& calibration,
                       double PointFit::*share,
                       draw::Colour colour) {
    chart.curves.push_back({name,
                            draw::empirical_distribution(heldout_correlations(
                                report, calibration.points, access_point, share)),
                            colour,
                            share == &PointFit::before});
  };
  add("floor plan and chain gains",
      report.methods.front().calibration,
      &PointFit::before,
      draw::kFaintInk);
  for (std::size_t i = 0; i < report.methods.size(); ++i) {
    const CalibrationMethodResult& result = report.methods[i];
    add(result.method, result.calibration, &PointFit::after, draw::curve_colour(i));
  }
  return draw_chart(chart);
}

std::vector<double> surface_displacements(const Scene& before, const Scene& after) {
  if (before.surfaces().size() != after.surfaces().size()) {
    return {};
  }
  std::vector<double> displacements;
  for (std::size_t i = 0; i < before.surfaces().size(); ++i) {
    displacements.push_back(distance(before.surfaces()[i].plane(), after.surfaces()[i].origin()));
  }
  return displacements;
}

Drawing draw_displacements(const CalibrationReport& report) {
  RAYLOC_CHECK(report.before.scene != nullptr);
  constexpr double kUpright = 0.3;   // |z| of the normal of a wall
  constexpr double kMinScale = 1.0;  // [mm], so that pure rounding stays grey
  const Scene& before = *report.before.scene;
  const auto& after = report.methods.front().calibration.room.scene;
  draw::RoomMap map;
  map.scene = &before;
  map.title = "Surfaces by how far they moved along their normals";
  map.value_name = "moved [mm]";
  map.antennas = antennas_of(report.before);
  map.colour = [](double share) { return draw::signed_colour(2.0 * share - 1.0); };
  const std::vector<double> moved =
      after != nullptr ? surface_displacements(before, *after) : std::vector<double>();
  double most = kMinScale;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Surface& surface = before.surfaces()[i];
    if (std::abs(surface.plane().normal.z) < kUpright) {
      const auto [from, to] = foot_of(surface);
      map.lines.push_back({from, to, moved[i] / kMillimetre});
      most = std::max(most, std::abs(moved[i]) / kMillimetre);
    }
  }
  map.lowest = -most;
  map.highest = most;
  return draw_room_map(map);
}

Drawing draw_residuals(const CalibrationReport& report, std::size_t access_point) {
  RAYLOC_CHECK(report.before.scene != nullptr);
  const std::string& id = report.access_points.at(access_point);
  draw::RoomMap map;
  map.scene = report.before.scene.get();
  map.title = "Points by their correlation after calibration, " + id;
  map.value_name = "correlation";
  map.ring_meaning = "held out";
  map.colour = draw::share_colour;
  for (draw::MapAntenna& antenna : antennas_of(report.before)) {
    if (antenna.name == id) {
      map.antennas.push_back(std::move(antenna));
    }
  }
  for (const PointFit& fit : report.methods.front().calibration.points) {
    if (fit.access_point == access_point) {
      map.dots.push_back(
          {report.positions.at(fit.point), fit.after, report.held_out.at(fit.point)});
    }
  }
  return draw_room_map(map);
}

}  // namespace rayloc
