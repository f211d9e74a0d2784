#include "engine/localize/cell_places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rayloc {

std::pair<double, CellMoments> summarise_places(const Lattice& lattice,
                                                const std::vector<double>& log_likelihood,
                                                double temper) {
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  double sum = 0.0;
  CellMoments m;
  for (std::size_t i = 0; i < log_likelihood.size(); ++i) {
    const double mass = std::exp(temper * (log_likelihood[i] - top));
    const Vec3d p = lattice.offset(i / lattice.count_y, i % lattice.count_y);
    sum += mass;
    m.x += mass * p.x;
    m.y += mass * p.y;
    m.xx += mass * p.x * p.x;
    m.xy += mass * p.x * p.y;
    m.yy += mass * p.y * p.y;
  }
  m.x /= sum;
  m.y /= sum;
  m.xx = m.xx / sum - m.x * m.x + lattice.step_x * lattice.step_x / 12.0;
  m.xy = m.xy / sum - m.x * m.y;
  m.yy = m.yy / sum - m.y * m.y + lattice.step_y * lattice.step_y / 12.0;
  return {top + std::log(sum / static_cast<double>(log_likelihood.size())) / temper, m};
}

}  // namespace rayloc
