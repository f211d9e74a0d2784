#include "daemon/cli/arguments/grid_argument.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "daemon/cli/arguments/number_list.h"

namespace rayloc::cli {

Expected<OfdmGrid> parse_grid(const std::string& text) {
  constexpr double kMaxTones = 65'536;
  std::array<double, 3> v{};
  const std::string example = "5.19e9,312500,128";
  RAYLOC_TRY(parse_number_list("--cfr", text, example, v));
  const auto [centre, spacing, count] = v;
  if (!(centre > 0.0) || !(spacing > 0.0) || count != std::trunc(count) || count < 1.0 ||
      count > kMaxTones) {
    return make_error(ErrorKind::kUsage,
                      "--cfr " + text +
                          ": write the centre and the spacing of the tones in Hz, and their number "
                          "from 1 to 65536: --cfr " +
                          example);
  }
  OfdmGrid grid{centre, spacing, {}};
  const int tones = static_cast<int>(count);
  for (int j = 0; j < tones; ++j) {
    grid.tone_index.push_back(static_cast<std::int16_t>(j - tones / 2));
  }
  return grid;
}

}  // namespace rayloc::cli
