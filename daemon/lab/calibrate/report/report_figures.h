// Pictures of a calibration's report.
#pragma once

#include <cstddef>

#include "daemon/lab/calibrate/report/calibration_report.h"
#include "daemon/site/plan/drawing.h"

namespace rayloc {

// Loss of one method over its iterations; on a logarithmic axis if that shows more.
draw::Drawing draw_loss(const CalibrationMethodResult& result);

// Held-out correlation of all methods over their iterations.
draw::Drawing draw_heldout_history(const CalibrationReport& report);

// Share of the held-out points with a correlation of at most x: floor plan and every method.
draw::Drawing draw_fit_distribution(const CalibrationReport& report, std::size_t access_point);

// The plan with its upright surfaces, coloured by their displacement along the outward normal, or
// along either normal. REQUIRES: report.before.scene.
draw::Drawing draw_displacements(const CalibrationReport& report);

// Every point, coloured by its correlation after the calibration that was written.
draw::Drawing draw_residuals(const CalibrationReport& report, std::size_t access_point);

// Displacement of each surface of `after` from that of `before` along before's normal [m]; empty if
// the two do not have the same surfaces.
std::vector<double> surface_displacements(const Scene& before, const Scene& after);

}  // namespace rayloc
