#include "engine/trace/diffuse/diffuse_density.h"

#include <algorithm>
#include <cmath>

namespace rayloc {

PowerDelay DiffuseDensity::power_delay() const {
  return rayloc::power_delay(echoes_, [](const DiffuseEcho& echo) { return echo.power; });
}

std::vector<double> DiffuseDensity::profile(double first, double step, std::size_t bins) const {
  std::vector<double> profile(bins, 0.0);
  for (const DiffuseEcho& echo : echoes_) {
    const double bin = std::floor((echo.tau - first) / step);
    if (bin >= 0.0 && bin < static_cast<double>(bins)) {
      profile[static_cast<std::size_t>(bin)] += echo.power;
    }
  }
  return profile;
}

double DiffuseDerivatives::power(std::size_t parameter) const {
  double sum = 0.0;
  for (std::size_t echo = 0; echo * parameters_ < values_.size(); ++echo) {
    sum += at(echo, parameter).power;
  }
  return sum;
}

}  // namespace rayloc
