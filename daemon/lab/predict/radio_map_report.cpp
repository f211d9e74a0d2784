#include "daemon/lab/predict/radio_map_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/base/arrays/npz_file.h"
#include "daemon/lab/draw/picture_bytes.h"
#include "daemon/lab/draw/room_map.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/plan/palette.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr double kNanosecond = 1e-9;  // [s]
// Range of a picture [dB], chosen: weaker cells are equally dark.
constexpr double kMaxRange = 60.0;

struct MapPicture {
  const char* name;
  RadioMapQuantity quantity;
};
constexpr std::array kMapPictures = {
    MapPicture{"path-gain", RadioMapQuantity::kPathGain},
    MapPicture{"delay-spread", RadioMapQuantity::kDelaySpread},
    MapPicture{"paths", RadioMapQuantity::kPathCount},
    MapPicture{"strongest", RadioMapQuantity::kStrongest},
};

double decibels(double ratio) { return 10.0 * std::log10(ratio); }

// The quantile at a share; NaN if there are no values.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::optional<double> value_of(const RadioMaps& maps, std::size_t cell, RadioMapQuantity quantity) {
  const std::int64_t number = maps.strongest[cell];
  if (number < 0) {
    return std::nullopt;
  }
  const RadioMap& map = maps.maps[static_cast<std::size_t>(number)];
  switch (quantity) {
    case RadioMapQuantity::kPathGain:
      return decibels(map.path_gain[cell]);
    case RadioMapQuantity::kDelaySpread:
      return map.delay_spread[cell] / kNanosecond;
    case RadioMapQuantity::kPathCount:
      return static_cast<double>(map.path_count[cell]);
    case RadioMapQuantity::kStrongest:
      return static_cast<double>(number);
  }
  return std::nullopt;
}

struct Captions {
  const char* title;
  const char* value_name;
};

Captions captions_of(RadioMapQuantity quantity) {
  switch (quantity) {
    case RadioMapQuantity::kPathGain:
      return {"path gain", "path gain [dB]"};
    case RadioMapQuantity::kDelaySpread:
      return {"delay spread", "delay spread [ns]"};
    case RadioMapQuantity::kPathCount:
      return {"number of paths", "paths"};
    case RadioMapQuantity::kStrongest:
      return {"the loudest access point", "loudest"};
  }
  return {"", ""};
}

// Scale ends that contain nearly all values, so that a
// single cell does not compress the colours of the others.
void scale_to(const std::vector<double>& values, RadioMapQuantity quantity, draw::RoomMap& map) {
  constexpr double kShownShare = 0.995;  // share, chosen
  map.highest = std::ceil(quantile(values, kShownShare));
  map.lowest =
      quantity == RadioMapQuantity::kPathGain
          ? std::max(std::floor(quantile(values, 1.0 - kShownShare)), map.highest - kMaxRange)
          : 0.0;
  if (!(map.lowest < map.highest)) {
    map.lowest = values.empty() ? 0.0 : map.highest - 1.0;
    map.highest = map.lowest + 1.0;
  }
}

void name_arrays(const RadioMaps& maps, draw::RoomMap& map) {
  map.lowest = 0.0;
  map.highest = static_cast<double>(std::max<std::size_t>(2, maps.arrays.size()) - 1);
  for (std::size_t i = 0; i < maps.arrays.size(); ++i) {
    map.names.push_back({maps.arrays[i].name, draw::curve_colour(i)});
  }
  const double last = map.highest;
  map.colour = [last](double share) {
    return draw::curve_colour(static_cast<std::size_t>(std::lround(share * last)));
  };
}

}  // namespace

draw::Drawing radio_map_picture(const RadioMaps& maps,
                                const Scene& scene,
                                RadioMapQuantity quantity) {
  RAYLOC_CHECK(!maps.maps.empty() && maps.maps.size() == maps.arrays.size());
  const Captions captions = captions_of(quantity);
  draw::RoomMap map;
  map.scene = &scene;
  const bool is_of_loudest = maps.maps.size() > 1 && quantity != RadioMapQuantity::kStrongest;
  map.title = fmt::format("{}: {} at a height of {:.2f} m{}",
                          maps.title,
                          captions.title,
                          maps.grid.first.z,
                          is_of_loudest ? ", of the loudest access point" : "");
  map.value_name = captions.value_name;
  std::vector<double> values;
  for (std::size_t cell = 0; cell < maps.strongest.size(); ++cell) {
    if (const auto value = value_of(maps, cell, quantity)) {
      map.cells.push_back({maps.grid.middle(cell), maps.grid.step, *value});
      values.push_back(*value);
    }
  }
  if (quantity == RadioMapQuantity::kStrongest) {
    name_arrays(maps, map);
  } else {
    scale_to(values, quantity, map);
    map.colour = draw::share_colour;
  }
  for (const NamedArray& one : maps.arrays) {
    map.antennas.push_back({one.name, one.array.pose.position});
  }
  return draw_room_map(map);
}

Expected<void> write_npz(const RadioMaps& maps, const std::string& path) {
  const RadioMapGrid& grid = maps.grid;
  std::vector<double> x;
  std::vector<double> y;
  x.reserve(grid.count_x);
  y.reserve(grid.count_y);
  for (std::size_t i = 0; i < grid.count_x; ++i) {
    x.push_back(grid.middle(i).x);
  }
  for (std::size_t i = 0; i < grid.count_y; ++i) {
    y.push_back(grid.middle(i * grid.count_x).y);
  }
  std::vector<double> gain;
  std::vector<double> spread;
  std::vector<std::uint32_t> count;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < maps.maps.size(); ++i) {
    const RadioMap& map = maps.maps[i];
    gain.insert(gain.end(), map.path_gain.begin(), map.path_gain.end());
    spread.insert(spread.end(), map.delay_spread.begin(), map.delay_spread.end());
    count.insert(count.end(), map.path_count.begin(), map.path_count.end());
    names.push_back(maps.arrays[i].name);
  }
  auto file = NpzFile::create(path);
  RAYLOC_TRY(file);
  const std::vector<std::size_t> of_each{maps.maps.size(), grid.count_y, grid.count_x};
  file->add("x", x, {x.size()});
  file->add("y", y, {y.size()});
  file->add("path_gain", gain, of_each);
  file->add("delay_spread", spread, of_each);
  file->add("path_count", count, of_each);
  file->add("strongest", maps.strongest, {grid.count_y, grid.count_x});
  file->add_texts("names", names);
  return file->close();
}

Expected<void> write_radio_maps(const RadioMaps& maps,
                                const Scene& scene,
                                const std::filesystem::path& folder) {
  for (const auto& [name, quantity] : kMapPictures) {
    if (quantity == RadioMapQuantity::kStrongest && maps.maps.size() == 1) {
      continue;
    }
    const draw::Drawing drawing = radio_map_picture(maps, scene, quantity);
    for (const char* ending : {".png", ".svg"}) {
      const std::string file = folder / (std::string(name) + ending);
      const auto bytes = draw::picture_bytes(drawing, file);
      RAYLOC_TRY(bytes);
      RAYLOC_TRY(write_file(file, *bytes));
    }
  }
  return write_npz(maps, folder / "radio-map.npz");
}

std::string radio_map_table(const RadioMaps& maps) {
  std::string text = fmt::format("{} x {} cells of {:.2f} m at a height of {:.2f} m\n",
                                 maps.grid.count_x,
                                 maps.grid.count_y,
                                 maps.grid.step,
                                 maps.grid.first.z);
  text += "  median  90 % above  delay spread  paths  loudest  no path  access point\n";
  const auto cells = static_cast<double>(maps.grid.size());
  for (std::size_t i = 0; i < maps.maps.size(); ++i) {
    const RadioMap& map = maps.maps[i];
    std::vector<double> gain;
    std::vector<double> spread;
    std::vector<double> count;
    for (std::size_t cell = 0; cell < map.path_gain.size(); ++cell) {
      if (map.path_count[cell] > 0) {
        gain.push_back(decibels(map.path_gain[cell]));
        spread.push_back(map.delay_spread[cell] / kNanosecond);
        count.push_back(static_cast<double>(map.path_count[cell]));
      }
    }
    const auto loudest = static_cast<double>(
        std::count(maps.strongest.begin(), maps.strongest.end(), static_cast<std::int64_t>(i)));
    text += fmt::format("{:5.1f} dB  {:7.1f} dB  {:9.1f} ns  {:5.0f}  {:5.0f} %  {:5.0f} %  {}\n",
                        quantile(gain, 0.5),
                        quantile(gain, 0.1),
                        quantile(spread, 0.5),
                        quantile(count, 0.5),
                        100.0 * loudest / cells,
                        100.0 * (cells - static_cast<double>(gain.size())) / cells,
                        maps.arrays[i].name);
  }
  return text;
}

}  // namespace rayloc
