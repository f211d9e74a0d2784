// A report of a made-up calibration of the synthetic room: two access points with measurements,
// four points, two of them held out.
#pragma once

#include <cstdint>

#include "daemon/lab/calibrate/report/calibration_report.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::test {

inline CalibrationReport sample_report() {
  CalibrationReport report;
  report.site = "office <3> & lab";
  report.calibration_id = "c0ffee";
  report.holdout = 0.5;
  report.seed = 7;
  report.access_points = {"a", "b", "c"};
  report.positions = {{-0.5, 0.1, 1.2}, {0.5, 0.2, 1.2}, {0.0, -0.4, 1.2}, {0.9, 0.7, 1.2}};
  report.held_out = {false, true, true, false};
  report.before = make_room();
  report.peak_memory_bytes = std::uint64_t{300} << 20U;
  report.fixes = {{1.0, 0.01, 2, 2, 1, 0.31, 0.0}, {0.6, 0.005, 2, 2, 2, 0.25, 0.4}};
  report.refused = {{"points.csv:9 a", "no frames at \"that\" time <1 s>"}};

  CalibrationMethodResult joint;
  joint.method = "joint";
  joint.seconds = 12.5;
  joint.rays = {.max_depth = 4, .transmission = true};
  joint.calibration.room = report.before;
  joint.calibration.parameters = {
      {{0.701, 0.7, 0.003}, parse_parameter_id("table.height"), "m", 0.02},
      {{0.012, 0.0, 0.001}, parse_parameter_id("west.+x.offset"), "m", 0.01},
      {{0.5, 0.0, 0.0}, parse_parameter_id("a.phase"), "rad", 0.0},
  };
  joint.calibration.points = {{0, 0, 0.40, 0.97},
                              {1, 0, 0.50, 0.90},
                              {2, 0, 0.60, 0.94},
                              {3, 0, 0.10, 0.20},
                              {1, 1, 0.30, 0.80}};
  joint.calibration.history = {{"gains", 0, 1000.0, 0.55}, {"joint", 1, 8.0, 0.92}};
  CalibrationMethodResult paper = joint;
  paper.method = "paper";
  paper.rays = {.max_depth = 2, .softness = 0.1};
  paper.seconds = 99.0;
  paper.calibration.points[1].after = 0.70;
  paper.calibration.points[2].after = 0.72;
  report.located = {{0, 0, 0.40, 0.96}, {1, 0, 0.50, 0.86}, {2, 0, 0.60, 0.90}};
  report.methods = {std::move(joint), std::move(paper)};
  return report;
}

}  // namespace rayloc::test
