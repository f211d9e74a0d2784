// MaterialTable: maps names of layers, materials and objects of a drawing to radio materials.
//
//   [[material]]                      # the first match is used
//   match = ["glass", "window*"]      # words of a name, in any case; `*`: any ending;
//                                     # a name without a letter is one word ("0")
//   itu = "glass"                     # or relative_permittivity and conductivity
//   thickness_m = 0.004
//
//   [otherwise]                       # for parts without a match
//   floor = "concrete"
//   ceiling = "ceiling_board"
//   wall = "plasterboard"
//   other = "wood"
//
//   [layers]                          # for a flat drawing: kind of the lines of a layer
//   wall = ["wall*"]                  # and window, door, furniture; other layers are left out
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/site/scene/scene_files.h"
#include "engine/base/expected.h"

namespace rayloc {

class TomlDocument;

// The default table, used without a table of the user's.
extern const char* const kDefaultMaterialTable;

class MaterialTable {
 public:
  struct Row {
    std::vector<std::string> words;  // in lower case
    StatedMaterial material;
  };

  static Expected<MaterialTable> read(const std::filesystem::path& file);
  static Expected<MaterialTable> parse(std::string_view text, const std::filesystem::path& file);

  // By the name of the material, then of the object; empty if neither contains a word of the table.
  std::optional<StatedMaterial> find(std::string_view material, std::string_view object) const;
  // part: "floor", "ceiling", "wall" or "other".
  StatedMaterial otherwise(std::string_view part) const;
  // "wall", "window", "door" or "furniture"; empty: none of these.
  std::string layer(std::string_view name) const;
  // Layers that hold walls, by their whole names in any case, whatever [layers] has of them.
  void name_walls(std::vector<std::string> layers) { named_walls_ = std::move(layers); }
  const std::vector<std::string>& named_walls() const { return named_walls_; }

 private:
  static Expected<MaterialTable> of(TomlDocument& document);

  std::vector<Row> rows_;
  std::vector<std::pair<std::string, StatedMaterial>> otherwise_;
  std::vector<std::pair<std::string, std::vector<std::string>>> layers_;  // words by kind
  std::vector<std::string> named_walls_;
};

}  // namespace rayloc
