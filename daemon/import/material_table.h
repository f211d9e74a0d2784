// MaterialTable: which radio material a layer, a material or an object of a drawing is of, by name.
//
//   [[material]]                      # the first that matches counts
//   match = ["glass", "window*"]      # words of a name, of any case; `*`: whatever follows
//   itu = "glass"                     # or relative_permittivity and conductivity
//   thickness_m = 0.004
//
//   [otherwise]                       # of what no name tells
//   floor = "concrete"
//   ceiling = "ceiling_board"
//   wall = "plasterboard"
//   other = "wood"
//
//   [layers]                          # of a flat drawing: what the lines of a layer are
//   wall = ["wall*"]                  # and window, door, furniture; what is in none is left out
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/scene/scene_files.h"
#include "engine/base/expected.h"

namespace rayloc {

class TomlDocument;

// The table that is used where a person names no other.
extern const char* const kDefaultMaterialTable;

class MaterialTable {
 public:
  struct Row {
    std::vector<std::string> words;  // in small letters
    StatedMaterial material;
  };

  static Expected<MaterialTable> read(const std::filesystem::path& file);
  static Expected<MaterialTable> parse(std::string_view text, const std::filesystem::path& file);

  // By the name of the material, then of the object; nothing where no word is in either.
  std::optional<StatedMaterial> find(std::string_view material, std::string_view object) const;
  // part: "floor", "ceiling", "wall" or "other".
  StatedMaterial otherwise(std::string_view part) const;
  // "wall", "window", "door" or "furniture"; empty: none of them.
  std::string layer(std::string_view name) const;

 private:
  static Expected<MaterialTable> of(TomlDocument& document);

  std::vector<Row> rows_;
  std::vector<std::pair<std::string, StatedMaterial>> otherwise_;
  std::vector<std::pair<std::string, std::vector<std::string>>> layers_;  // words by kind
};

}  // namespace rayloc
