// Coverage of antennas over a room: the arrays of `rayloc scene map`.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "engine/room/radio_map.h"
#include "engine/trace/radio_device.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/raising.h"
#include "python/tracing.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

using Corner = std::array<double, 2>;

constexpr double kUsualHeight = 1.2;  // [m], of a device above the lowest point: `rayloc scene map`
constexpr double kMaxCells = 4e6;     // a count, chosen: as in `rayloc scene map`

RadioMapGrid map_grid(const Scene& scene,
                      double cell_size,
                      std::optional<double> height,
                      const std::optional<std::pair<Corner, Corner>>& bounds) {
  Vec3d lower = scene.bounds_min();
  Vec3d upper = scene.bounds_max();
  const double z = height.value_or(lower.z + kUsualHeight);
  if (bounds) {
    lower = {bounds->first[0], bounds->first[1], lower.z};
    upper = {bounds->second[0], bounds->second[1], upper.z};
  }
  const double area = (upper.x - lower.x) * (upper.y - lower.y);
  if (!(lower.x <= upper.x && lower.y <= upper.y && std::isfinite(area))) {
    refuse("radio_map: bounds are the least and the greatest corner, ((x, y), (x, y)) in metres");
  }
  if (!std::isfinite(z)) {
    refuse("radio_map: height is a finite number of metres");
  }
  if (!(cell_size > 0.0 && std::isfinite(cell_size)) ||
      !(radio_map_cells(upper.x - lower.x, cell_size) *
            radio_map_cells(upper.y - lower.y, cell_size) <=
        kMaxCells)) {
    refuse("radio_map: cell_size is above 0 m, and 4,000,000 cells are the most");
  }
  return radio_map_grid(lower, upper, z, cell_size);
}

AntennaArray array_at(const Transmitter& antenna) {
  AntennaArray array;
  array.pose = {antenna.position, antenna.orientation};
  array.element_offset = {Vec3d{}};
  array.pattern = antenna.pattern;
  array.polarization = antenna.polarization;
  return array;
}

py::array_t<double> centres_of(const RadioMapGrid& grid) {
  std::vector<double> centres;
  centres.reserve(3 * grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec3d middle = grid.middle(i);
    centres.insert(centres.end(), {middle.x, middle.y, middle.z});
  }
  return array_of(std::move(centres), {size_of(grid.count_y), size_of(grid.count_x), 3});
}

// All maps in one array, [map][y][x].
template <typename T>
py::array_t<T> stacked(const std::vector<RadioMap>& maps,
                       std::vector<T> RadioMap::*which,
                       const RadioMapGrid& grid) {
  std::vector<T> all;
  all.reserve(maps.size() * grid.size());
  for (const RadioMap& map : maps) {
    all.insert(all.end(), (map.*which).begin(), (map.*which).end());
  }
  return array_of(std::move(all),
                  {size_of(maps.size()), size_of(grid.count_y), size_of(grid.count_x)});
}

py::tuple maps_of(const TracerHandle& handle,
                  const std::vector<Transmitter>& antennas,
                  double cell_size,
                  std::optional<double> height,
                  const std::optional<std::pair<Corner, Corner>>& bounds) {
  if (antennas.empty()) {
    refuse("radio_map: at least one transmitter is needed");
  }
  const RadioMapGrid grid = map_grid(*handle.scene.scene, cell_size, height, bounds);
  std::vector<RadioMap> maps;
  std::vector<std::int64_t> strongest;
  {
    const py::gil_scoped_release unlocked;
    maps.reserve(antennas.size());
    for (const Transmitter& antenna : antennas) {
      maps.push_back(radio_map(handle.tracer, array_at(antenna), grid));
    }
    strongest = strongest_of(maps);
  }
  return py::make_tuple(
      stacked(maps, &RadioMap::path_gain, grid),
      stacked(maps, &RadioMap::delay_spread, grid),
      stacked(maps, &RadioMap::path_count, grid),
      array_of(std::move(strongest), {size_of(grid.count_y), size_of(grid.count_x)}),
      centres_of(grid));
}

}  // namespace

void bind_radio_map(py::module_& module) {
  module.def("radio_maps",
             maps_of,
             py::arg("tracer"),
             py::arg("tx"),
             py::arg("cell_size"),
             py::arg("height"),
             py::arg("bounds"),
             "path_gain, delay_spread, path_count, strongest and cell_centers of rayloc.RadioMap.");
}

}  // namespace rayloc::python
