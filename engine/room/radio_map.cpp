#include "engine/room/radio_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/check.h"
#include "engine/base/parallel.h"
#include "engine/trace/power_delay.h"
#include "engine/trace/radio_device.h"

namespace rayloc {
namespace {

struct Cell {
  double path_gain = 0.0;
  double delay_spread = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t path_count = 0;
};

Cell summarise(const Paths& paths) {
  Cell cell;
  for (const Path& path : paths) {
    cell.path_count += abs2(path.a) > 0.0 ? 1U : 0U;
  }
  if (cell.path_count > 0) {
    const PowerDelay found = power_delay(paths, [](const Path& path) { return abs2(path.a); });
    cell.path_gain = found.power;
    cell.delay_spread = found.delay_spread;
  }
  return cell;
}

}  // namespace

double radio_map_cells(double length, double step) {
  return std::max(1.0, std::floor(length / step + 1e-9));
}

RadioMapGrid radio_map_grid(const Vec3d& lower, const Vec3d& upper, double height, double step) {
  RAYLOC_CHECK(step > 0.0 && lower.x <= upper.x && lower.y <= upper.y);
  RadioMapGrid grid;
  grid.step = step;
  grid.count_x = static_cast<std::size_t>(radio_map_cells(upper.x - lower.x, step));
  grid.count_y = static_cast<std::size_t>(radio_map_cells(upper.y - lower.y, step));
  const auto first = [&](double low, double high, std::size_t cells) {
    return 0.5 * (low + high) - 0.5 * step * static_cast<double>(cells - 1);
  };
  grid.first = {
      first(lower.x, upper.x, grid.count_x), first(lower.y, upper.y, grid.count_y), height};
  return grid;
}

RadioMap radio_map(const PathTracer& tracer,
                   const AntennaArray& array,
                   const RadioMapGrid& grid,
                   const std::function<void()>& cell_done) {
  const ReceiverTracer at_array = tracer.at(array_origin<Receiver>(array));
  std::vector<Cell> cells(grid.size());
  parallel_for(cells.size(), 16, [&](std::size_t i) {
    Transmitter device;
    device.position = grid.middle(i);
    if (!(device.position == array.pose.position)) {  // an antenna does not receive its own signal
      cells[i] = summarise(at_array.trace(device));
    }
    if (cell_done) {
      cell_done();
    }
  });
  RadioMap map;
  map.path_gain.reserve(cells.size());
  map.delay_spread.reserve(cells.size());
  map.path_count.reserve(cells.size());
  for (const Cell& cell : cells) {
    map.path_gain.push_back(cell.path_gain);
    map.delay_spread.push_back(cell.delay_spread);
    map.path_count.push_back(cell.path_count);
  }
  return map;
}

std::vector<std::int64_t> strongest_of(const std::vector<RadioMap>& maps) {
  RAYLOC_CHECK(!maps.empty());
  std::vector<std::int64_t> strongest(maps.front().path_gain.size(), -1);
  for (std::size_t cell = 0; cell < strongest.size(); ++cell) {
    double most = 0.0;
    for (std::size_t i = 0; i < maps.size(); ++i) {
      if (maps[i].path_gain[cell] > most) {
        most = maps[i].path_gain[cell];
        strongest[cell] = static_cast<std::int64_t>(i);
      }
    }
  }
  return strongest;
}

}  // namespace rayloc
