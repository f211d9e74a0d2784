#include "engine/baselines/paths/bearing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/baselines/two_pi.h"

namespace rayloc {
namespace {

// Allowed position error of an antenna relative to the spacing; a ratio, chosen: calibrated arrays
// are off by 1 %, and at 5 % a bearing of 1.5 wavelengths is off by half a radian.
constexpr double kMaxOff = 0.05;

}  // namespace

std::optional<AntennaLine> antenna_line(const AntennaArray& array,
                                        std::vector<std::size_t> elements) {
  if (elements.size() < 2) {
    return std::nullopt;
  }
  const auto& offset = array.element_offset;
  std::sort(elements.begin(), elements.end(), [&](std::size_t a, std::size_t b) {
    return offset[a].y < offset[b].y;
  });
  const Vec3d& first = offset[elements.front()];
  const auto gaps = static_cast<double>(elements.size() - 1);
  const double spacing = (offset[elements.back()].y - first.y) / gaps;
  if (!(spacing > 0.0)) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Vec3d off =
        offset[elements[i]] - first - Vec3d{0.0, spacing * static_cast<double>(i), 0.0};
    if (norm(off) > kMaxOff * spacing) {
      return std::nullopt;
    }
  }
  return AntennaLine{std::move(elements), spacing};
}

double psi_of(const AntennaArray& array,
              const AntennaLine& line,
              const Vec3d& place,
              double wavelength) {
  const double middle = 0.5 * static_cast<double>(line.element.size() - 1);
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < line.element.size(); ++i) {
    const double at = static_cast<double>(i) - middle;
    sum -= at * norm(place - element_position(array, line.element[i]));
    squares += at * at;
  }
  return kTwoPi / wavelength * sum / squares;
}

std::vector<double> sines_of(double psi, double spacing, double wavelength) {
  const double turns = spacing / wavelength;
  std::vector<double> sines;
  for (double n = std::ceil(-turns - psi / kTwoPi); n + psi / kTwoPi <= turns; n += 1.0) {
    sines.push_back((n + psi / kTwoPi) / turns);
  }
  return sines;
}

}  // namespace rayloc
