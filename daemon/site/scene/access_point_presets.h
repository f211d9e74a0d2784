// Known access point models, with their receiving antennas and the cores connected to them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rayloc {

struct AntennaPreset {
  std::string_view model;
  std::string_view remark;       // for people
  double spacing_m;              // [m], between neighbours
  std::array<int, 3> rx_chains;  // from the left, seen from in front of it: local -y first
};

// The order and 8.9 cm of the RT-AX86U: IndoLocate's script (github.com/intentlab-iitk/IndoLocate).
// The RT-AC86U has the same three outer antennas and cores 0 to 3; the order of its cores has no
// source, so a person is asked to check it. rayloc calibrate reports two that are exchanged.
inline constexpr std::array<AntennaPreset, 2> kAntennaPresets = {{
    {"RT-AX86U", "three antennas, 8.9 cm apart: measure your own", 0.089, {2, 0, 3}},
    {"RT-AC86U",
     "three antennas: measure the distance, and check the order of cores",
     0.089,
     {0, 1, 2}},
}};

inline std::vector<std::string> preset_models() {
  std::vector<std::string> models;
  models.reserve(kAntennaPresets.size());
  for (const AntennaPreset& preset : kAntennaPresets) {
    models.emplace_back(preset.model);
  }
  return models;
}

// The first preset if `model` matches none.
inline const AntennaPreset& preset_of(std::string_view model) {
  for (const AntennaPreset& preset : kAntennaPresets) {
    if (preset.model == model) {
      return preset;
    }
  }
  return kAntennaPresets.front();
}

}  // namespace rayloc
