#include "engine/posterior/room_map.h"

#include <cmath>
#include <cstddef>

#include "engine/base/parallel.h"

namespace rayloc {

RoomMap fuse(std::span<const std::vector<double>> maps, const AccessPointFusion& fusion) {
  const std::size_t cells = maps.front().size();
  RoomMap map;
  map.log_likelihood.resize(cells);
  map.fault_probability.assign(fusion.size(), std::vector<double>(cells));
  parallel_for(cells, 256, [&](std::size_t cell) {
    std::vector<double> of_each(fusion.size());
    for (std::size_t i = 0; i < of_each.size(); ++i) {
      of_each[i] = maps[i][cell];
      map.fault_probability[i][cell] = fusion.faulty(i, of_each[i]);
    }
    map.log_likelihood[cell] = fusion.log_likelihood(of_each);
  });
  return map;
}

std::vector<double> fault_probabilities(const RoomMap& map, double likelihood_exponent) {
  const double log_sum = log_mean_exp(map.log_likelihood, likelihood_exponent) +
                         std::log(static_cast<double>(map.log_likelihood.size()));
  std::vector<double> result;
  for (const std::vector<double>& of_cell : map.fault_probability) {
    double fault_probability = 0.0;
    for (std::size_t cell = 0; cell < of_cell.size(); ++cell) {
      fault_probability +=
          std::exp(likelihood_exponent * map.log_likelihood[cell] - log_sum) * of_cell[cell];
    }
    result.push_back(fault_probability);
  }
  return result;
}

}  // namespace rayloc
