#include "daemon/cli/feed/age_text.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace rayloc::cli {

std::string age_text(double seconds) {
  if (seconds < 10.0) {
    return fmt::format("{:.1f} s", std::max(seconds, 0.0));
  }
  if (seconds < 120.0) {
    return fmt::format("{:.0f} s", seconds);
  }
  return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0)
                          : fmt::format("{:.0f} h", seconds / 3600.0);
}

}  // namespace rayloc::cli
