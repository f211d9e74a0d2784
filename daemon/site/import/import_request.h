// import_options: checks what a person states about a file to import.
#pragma once

#include <optional>
#include <string>

#include "daemon/site/import/import_scene.h"
#include "engine/base/expected.h"

namespace rayloc {

// As written; empty: not stated.
struct ImportRequest {
  std::string unit;                 // mm, cm, m, in or ft
  std::string up;                   // y or z
  std::optional<double> scale;      // of a drawing on paper: 50 for 1:50
  std::optional<double> height;     // [m], floor to ceiling of a flat drawing
  std::optional<double> tolerance;  // [m], of a scan from its planes
};

// An Error (kUsage) names the option of `rayloc scene import` whose value is invalid. Thread
// safety: a pure function.
Expected<ImportOptions> import_options(const ImportRequest& request);

}  // namespace rayloc
