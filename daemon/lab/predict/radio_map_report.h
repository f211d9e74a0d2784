// Output of `rayloc scene map`: pictures, arrays, and a line for each access point.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/site/plan/drawing.h"
#include "engine/base/expected.h"
#include "engine/room/radio_map.h"
#include "engine/scene/antenna_array.h"
#include "engine/scene/scene.h"

namespace rayloc {

struct NamedArray {
  std::string name;  // of the access point
  AntennaArray array;
};

struct RadioMaps {
  std::string title;  // of the site or the scene
  RadioMapGrid grid;
  std::vector<NamedArray> arrays;
  std::vector<RadioMap> maps;           // [array]
  std::vector<std::int64_t> strongest;  // [cell], strongest_of() the maps
};

// Quantity shown at each cell, of the array with the strongest signal there.
enum class RadioMapQuantity : std::uint8_t { kPathGain, kDelaySpread, kPathCount, kStrongest };

// REQUIRES: at least one array.
draw::Drawing radio_map_picture(const RadioMaps& maps,
                                const Scene& scene,
                                RadioMapQuantity quantity);

// x [count_x], y [count_y], path_gain, delay_spread and path_count [array][count_y][count_x],
// strongest [count_y][count_x] (-1: no path), names. kUnavailable if it cannot be written.
Expected<void> write_npz(const RadioMaps& maps, const std::string& path);

// Writes the pictures of all quantities as .png and .svg (kStrongest with several arrays only) and
// radio-map.npz into a folder that exists.
Expected<void> write_radio_maps(const RadioMaps& maps,
                                const Scene& scene,
                                const std::filesystem::path& folder);

// A table for people, one line per access point.
std::string radio_map_table(const RadioMaps& maps);

}  // namespace rayloc
