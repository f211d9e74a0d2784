#include "engine/posterior/room_map.h"

#include <cmath>
#include <cstddef>

#include "engine/base/parallel.h"

namespace rayloc {

RoomMap fuse(std::span<const std::vector<double>> maps, const AccessPointFusion& fusion) {
  const std::size_t cells = maps.front().size();
  RoomMap map;
  map.log_likelihood.resize(cells);
  map.doubt.assign(fusion.size(), std::vector<double>(cells));
  parallel_for(cells, 256, [&](std::size_t cell) {
    std::vector<double> of_each(fusion.size());
    for (std::size_t i = 0; i < of_each.size(); ++i) {
      of_each[i] = maps[i][cell];
      map.doubt[i][cell] = fusion.faulty(i, of_each[i]);
    }
    map.log_likelihood[cell] = fusion.log_likelihood(of_each);
  });
  return map;
}

std::vector<double> doubts(const RoomMap& map, double likelihood_exponent) {
  const double log_sum = log_mean_exp(map.log_likelihood, likelihood_exponent) +
                         std::log(static_cast<double>(map.log_likelihood.size()));
  std::vector<double> result;
  for (const std::vector<double>& of_cell : map.doubt) {
    double doubt = 0.0;
    for (std::size_t cell = 0; cell < of_cell.size(); ++cell) {
      doubt += std::exp(likelihood_exponent * map.log_likelihood[cell] - log_sum) * of_cell[cell];
    }
    result.push_back(doubt);
  }
  return result;
}

}  // namespace rayloc
