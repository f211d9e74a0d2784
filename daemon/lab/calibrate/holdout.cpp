#include "daemon/lab/calibrate/holdout.h"

#include <numeric>
#include <random>
#include <utility>

namespace rayloc {

std::vector<bool> draw_holdout(std::size_t count, double share, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 random(seed);
  for (std::size_t i = count; i > 1; --i) {
    std::swap(order[i - 1], order[random() % i]);
  }
  std::vector<bool> held(count);
  const auto most = static_cast<std::size_t>(share * static_cast<double>(count));
  for (std::size_t i = 0; i < most; ++i) {
    held[order[i]] = true;
  }
  return held;
}

}  // namespace rayloc
