// RadioMap: reception of an access point over a room, on a lattice at one height.
//
// The device is isotropic and vertically polarized; the array is one antenna at its origin, with
// its pattern and polarization. By reciprocity either of the two may be the transmitter.
//
// Path gain adds the powers of the paths and not their amplitudes, as Sionna RT's RadioMap does:
// the mean over a wavelength or two, without small-scale fading. Delay spread: the root mean square
// about the mean delay, weighted by power (ITU-R P.1407-8).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/antenna_array.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {

struct RadioMapGrid {
  Vec3d first;        // [m], world, the middle of cell 0
  double step = 0.0;  // [m]
  std::size_t count_x = 0;
  std::size_t count_y = 0;

  std::size_t size() const { return count_x * count_y; }
  // Cells are counted along x first: [y][x].
  Vec3d middle(std::size_t cell) const {
    const std::size_t x = cell % count_x;
    const std::size_t y = cell / count_x;
    return first + Vec3d{step * static_cast<double>(x), step * static_cast<double>(y), 0.0};
  }
};

// Number of cells of side `step` on a length [m], at least one: a whole number of any size.
// REQUIRES: step > 0.
double radio_map_cells(double length, double step);

// Cells that cover a rectangle, the same number on both sides of its middle, at least one.
// REQUIRES: step > 0, lower <= upper.
RadioMapGrid radio_map_grid(const Vec3d& lower, const Vec3d& upper, double height, double step);

// Radio map: one value per cell.
struct RadioMap {
  std::vector<double> path_gain;          // received over sent power; 0: no path
  std::vector<double> delay_spread;       // [s]; NaN: no path
  std::vector<std::uint32_t> path_count;  // number of paths with power
};

// Computes the map on all cores. `cell_done` may be empty; it is called from any thread.
RadioMap radio_map(const PathTracer& tracer,
                   const AntennaArray& array,
                   const RadioMapGrid& grid,
                   const std::function<void()>& cell_done = {});

// For each cell, the number of the map with the largest path gain, -1 where no map has a path.
// REQUIRES: maps of one grid, at least one.
std::vector<std::int64_t> strongest_of(const std::vector<RadioMap>& maps);

}  // namespace rayloc
