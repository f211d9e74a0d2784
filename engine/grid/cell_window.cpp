#include "engine/grid/cell_window.h"

namespace rayloc {

std::array<std::size_t, 2> kept_range(const std::vector<double>& mass, double out) {
  std::size_t begin = 0;
  std::size_t end = mass.size();
  for (double sum = mass[begin]; sum <= out && begin + 1 < end; sum += mass[begin]) {
    ++begin;
  }
  for (double sum = mass[end - 1]; sum <= out && begin + 1 < end; sum += mass[end - 1]) {
    --end;
  }
  return {begin, end};
}

}  // namespace rayloc
