// Figures of `rayloc evaluate --plot`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "daemon/lab/draw/room_map.h"
#include "daemon/lab/evaluate/hypothesis_reliability.h"
#include "daemon/lab/evaluate/point_result.h"
#include "daemon/lab/evaluate/truth.h"
#include "daemon/site/plan/drawing.h"
#include "engine/room/location_estimate.h"
#include "engine/scene/scene.h"

namespace rayloc {

struct NamedErrors {
  std::string name;
  std::vector<double> errors;  // [m]; infinite: missed
};

// Distributions of errors; a curve ends below 1 by the share of missed points.
draw::Drawing draw_error_distributions(std::span<const NamedErrors> all);

// Map of the errors: a dot at each point of the truth, a line to its estimate. REQUIRES:
// truth.size() == matches.size().
draw::Drawing draw_error_map(const Scene& scene,
                             std::vector<draw::MapAntenna> antennas,
                             std::span<const TruthPoint> truth,
                             std::span<const LocationEstimate* const> matches);

// The share of points with the truth in the stated region of each probability.
draw::Drawing draw_coverage(std::span<const PointResult> results);

// Frequency with which hypotheses of each weight, and the residual probability, are right.
draw::Drawing draw_reliability(const StatedOutcomes& outcomes);

}  // namespace rayloc
