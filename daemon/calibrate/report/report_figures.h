// The pictures of a calibration's report.
#pragma once

#include <cstddef>

#include "daemon/calibrate/report/calibration_report.h"
#include "daemon/draw/drawing.h"

namespace rayloc {

// The loss of one method over its iterations; on a logarithmic axis where that shows more.
draw::Drawing draw_loss(const CalibrationMethodResult& result);

// The held-out correlation of all methods over their iterations.
draw::Drawing draw_heldout_history(const CalibrationReport& report);

// The share of the points held out whose correlation is at most x: floor plan and every method.
draw::Drawing draw_fit_distribution(const CalibrationReport& report, std::size_t access_point);

// The plan with its upright surfaces by how far each moved along the normal that it has outwards or
// to either side. REQUIRES: report.before.scene.
draw::Drawing draw_displacements(const CalibrationReport& report);

// Every point by its correlation after the calibration that was written.
draw::Drawing draw_residuals(const CalibrationReport& report, std::size_t access_point);

// How far each surface of `after` lies from that of `before` along before's normal [m]; empty when
// the two do not have the same surfaces.
std::vector<double> surface_displacements(const Scene& before, const Scene& after);

}  // namespace rayloc
