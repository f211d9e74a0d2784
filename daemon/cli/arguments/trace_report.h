// The two output forms of `rayloc trace`.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/diffuse/diffuse_density.h"
#include "engine/trace/paths.h"

namespace rayloc::cli {

struct TraceReport {
  Paths paths;
  std::optional<std::vector<std::complex<double>>> cfr;
  // Derivatives of the sum of |h|^2 over the grid, by parameter.
  std::optional<double> power;
  std::vector<std::pair<std::string, double>> gradient;
  std::optional<DiffuseDensity> diffuse;
  std::string note;  // notable property of the link, may be empty
};

// One line with the keys of INTERFACE 3.4; numbers with 17 significant digits, paths in canonical
// order.
std::string trace_json(const TraceReport& report, const Scene& scene);

// Table for people: one line per path, the strongest first.
std::string trace_table(const TraceReport& report, const Scene& scene);

}  // namespace rayloc::cli
