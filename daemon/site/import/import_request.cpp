#include "daemon/site/import/import_request.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "daemon/site/import/drawn_plan.h"

namespace rayloc {
namespace {

struct StatedUnit {
  std::string_view name;
  double metres;
};
constexpr std::array kStatedUnits = {StatedUnit{"mm", 0.001},
                                     StatedUnit{"cm", 0.01},
                                     StatedUnit{"m", 1.0},
                                     StatedUnit{"in", 0.0254},
                                     StatedUnit{"ft", 0.3048}};

}  // namespace

Expected<ImportOptions> import_options(const ImportRequest& request) {
  ImportOptions options;
  if (!request.unit.empty()) {
    const auto unit = std::find_if(kStatedUnits.begin(),
                                   kStatedUnits.end(),
                                   [&](const StatedUnit& one) { return one.name == request.unit; });
    if (unit == kStatedUnits.end()) {
      return make_error(ErrorKind::kUsage,
                        "--unit: '" + request.unit + "' is none of mm, cm, m, in, ft");
    }
    options.units.metres = unit->metres;
  }
  if (!request.up.empty()) {
    if (request.up != "y" && request.up != "z") {
      return make_error(ErrorKind::kUsage, "--up: '" + request.up + "' is neither y nor z");
    }
    options.units.up = request.up[0];
  }
  if (request.scale) {
    if (!request.unit.empty()) {
      return make_error(ErrorKind::kUsage,
                        "--scale states the scale of a drawing on paper, --unit the unit of the "
                        "file; write one of them");
    }
    constexpr double kMost = 1000.0;  // scale of site plans
    if (!(*request.scale >= 1.0 && *request.scale <= kMost)) {
      return make_error(ErrorKind::kUsage, "--scale: write 50 for 1:50, from 1 to 1000");
    }
    options.units.scale = *request.scale;
  }
  if (request.height) {
    constexpr double kMost = 20.0;  // [m], height of a hall
    if (!(*request.height > kHead && *request.height <= kMost)) {
      return make_error(ErrorKind::kUsage,
                        "--height: write metres, above 2.1 (the top of windows) and up to 20");
    }
    options.units.height = *request.height;
  }
  if (request.tolerance) {
    constexpr double kMost = 0.5;  // [m]; more would join opposite sides of furniture
    if (!(*request.tolerance > 0.0 && *request.tolerance <= kMost)) {
      return make_error(ErrorKind::kUsage, "--tolerance: write metres, above 0 and up to 0.5");
    }
    options.tolerance = *request.tolerance;
  }
  return options;
}

}  // namespace rayloc
