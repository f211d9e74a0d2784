#include "daemon/site/import/material_table.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/utf8_text.h"
#include "daemon/site/model/toml_reader.h"
#include "engine/em/radio_material.h"

namespace rayloc {

// Thicknesses are those of common boards and panes.
const char* const kDefaultMaterialTable =
    R"(# Names of layers, materials and objects, and their radio materials.
# The first row one of whose words is in a name counts; letters of any case. A name's words end where
# letters do, and before a capital letter: "Door_2", "oakDoor". With an "s" they are the same;
# "gips*" is any word that begins so, "*" any name. A name without a letter, such as the layer "0",
# is written whole.
[[material]]
match = ["glass", "glas", "window*", "fenster*", "verre", "glazing"]
itu = "glass"
thickness_m = 0.004
[[material]]
match = ["metal*", "steel", "alumin*", "radiator", "fridge", "refrigerator", "whiteboard", "cabinet", "oven", "stove", "dishwasher", "washer", "stahl"]
itu = "metal"
thickness_m = 0.01
[[material]]
match = ["ceiling*", "acoustic", "decke"]
itu = "ceiling_board"
thickness_m = 0.015
[[material]]
match = ["plaster*", "gypsum", "drywall", "gips*", "partition"]
itu = "plasterboard"
thickness_m = 0.0125
[[material]]
match = ["brick*", "masonry", "ziegel*", "mauerwerk"]
itu = "brick"
thickness_m = 0.12
[[material]]
match = ["concrete", "beton*", "stahlbeton*", "slab", "floor*", "boden*", "screed"]
itu = "concrete"
thickness_m = 0.1
[[material]]
match = ["chipboard", "mdf"]
itu = "chipboard"
thickness_m = 0.02
[[material]]
match = ["wood*", "door", "table", "desk", "chair", "shelf", "bookshelf", "shelves", "furniture", "holz*", "timber", "oak", "sofa", "bed", "storage"]
itu = "wood"
thickness_m = 0.02

[otherwise]  # surfaces without a name above, by their place
floor = "concrete"
ceiling = "ceiling_board"
wall = "plasterboard"
other = "wood"

[layers]  # kinds of the lines in a layer of a flat drawing (DXF, SVG); other layers are left out
window = ["window*", "fenster*", "glaz*", "fenetre*", "fenêtre*", "glas", "ventana*", "finestr*", "raam", "ramen"]
door = ["door*", "tuer*", "tür*", "porte*", "puerta*", "porta", "deur*"]
wall = ["wall*", "wand*", "waende*", "wänd*", "mauer*", "mur", "muro*", "muri", "pared*", "muur", "muren", "partition"]
furniture = ["furn*", "desk", "table", "moebel*", "möbel*", "mobilier", "muebles", "mobili", "meubel*", "equip*"]
)";

namespace {

constexpr double kCheckedAt = 5.19e9;  // [Hz]: in the band of the measurements

// In this order: a layer of windows may match walls as well ("A-WALL-WINDOW").
constexpr std::array<std::string_view, 4> kLayers = {"window", "door", "wall", "furniture"};
constexpr std::array<std::string_view, 4> kParts = {"floor", "ceiling", "wall", "other"};

// Its words in lower case, with a space before and after each. A name without a letter is one word.
std::string split_words(std::string_view name) {
  const std::string lower = lower_case(name);
  std::string words = " ";
  bool was_small = false;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto letter = static_cast<unsigned char>(name[i]);
    // A non-ASCII byte may belong to a letter of another alphabet.
    const bool is_letter = std::isalpha(letter) != 0 || letter >= 0x80;
    const bool is_rest = (letter & 0xc0U) == 0x80U;
    const bool is_wide_capital = letter == 0xc3 && lower.substr(i, 2) != name.substr(i, 2);
    const bool is_capital = lower[i] != name[i] || is_wide_capital;
    if ((!is_letter || (is_capital && was_small && !is_rest)) && words.back() != ' ') {
      words += ' ';
    }
    if (is_letter) {
      words += lower[i];
    }
    was_small = is_letter && !is_capital;
  }
  const std::size_t begin = lower.find_first_not_of(" \t");
  if (words == " " && begin != std::string::npos) {
    words += lower.substr(begin, lower.find_last_not_of(" \t") + 1 - begin);
  }
  return words.back() == ' ' ? words : words + ' ';
}

bool holds(const std::string& words, const std::string& word) {
  if (word.back() == '*') {
    return words.find(' ' + word.substr(0, word.size() - 1)) != std::string::npos;
  }
  return words.find(' ' + word + ' ') != std::string::npos ||
         words.find(' ' + word + "s ") != std::string::npos;
}

std::vector<std::string> read_words(const TomlTable& table, std::string_view key) {
  std::vector<std::string> found;
  for (const std::string& word : table.strings(key)) {
    const bool is_prefix = word.ends_with('*');
    const std::string words = split_words(is_prefix ? word.substr(0, word.size() - 1) : word);
    if (words == " " && !is_prefix) {
      table.error_at(key, fmt::format("'{}' holds an empty word", key));
      continue;
    }
    found.push_back((words == " " ? "" : words.substr(1, words.size() - 2)) +
                    (is_prefix ? "*" : ""));
  }
  return found;
}

bool holds_one(const std::string& words, const std::vector<std::string>& of) {
  return std::any_of(
      of.begin(), of.end(), [&](const std::string& word) { return holds(words, word); });
}

void check_itu(const TomlTable& table, std::string_view key, const StatedMaterial& material) {
  if (const auto valid = itu_material(material.itu, kCheckedAt, material.thickness); !valid) {
    table.error_at(key, "'" + std::string(key) + "': " + valid.error().message);
  }
}

StatedMaterial read_row(const TomlTable& table) {
  StatedMaterial material;
  material.thickness = table.number("thickness_m", {1e-5, 10.0, "m"}).value_or(kDefaultThickness);
  const auto itu = table.string("itu");
  const auto permittivity = table.number("relative_permittivity", {1.0, 1e4});
  const auto conductivity = table.number("conductivity", {0.0, 1e9, "S/m"});
  if (itu) {
    material.name = *itu;
    material.itu = *itu;
    check_itu(table, "itu", material);
    return material;
  }
  table.require({{"relative_permittivity", "relative_permittivity = 2.7"},
                 {"conductivity", "conductivity = 0.01"},
                 {"name", "name = \"cork\""}});
  material.name = table.string("name").value_or("material");
  material.relative_permittivity = permittivity.value_or(1.0);
  material.conductivity = conductivity.value_or(0.0);
  if (!is_object_name(material.name)) {
    table.error_at("name", "'name': write letters, digits, '-' and '_' only");
  }
  return material;
}

}  // namespace

Expected<MaterialTable> MaterialTable::read(const std::filesystem::path& file) {
  const auto document = TomlDocument::read(file);
  return document ? of(**document) : tl::make_unexpected(document.error());
}

Expected<MaterialTable> MaterialTable::parse(std::string_view text,
                                             const std::filesystem::path& file) {
  const auto document = TomlDocument::parse(text, file);
  return document ? of(**document) : tl::make_unexpected(document.error());
}

Expected<MaterialTable> MaterialTable::of(TomlDocument& document) {
  MaterialTable table;
  const TomlTable root = document.root();
  for (const TomlTable& row : root.tables("material")) {
    row.require({{"match", R"(match = ["glass", "window"])"}});
    MaterialTable::Row read{{}, read_row(row)};
    read.words = read_words(row, "match");
    table.rows_.push_back(std::move(read));
  }
  const auto otherwise = root.table("otherwise");
  for (const std::string_view part : kParts) {
    const std::string itu =
        otherwise ? otherwise->string(part).value_or("wood") : std::string("wood");
    StatedMaterial material;
    // A row with that material states its thickness.
    const auto row = std::find_if(table.rows_.begin(), table.rows_.end(), [&](const Row& one) {
      return one.material.name == itu;
    });
    if (row != table.rows_.end()) {
      material = row->material;
    } else {
      material.name = itu;
      material.itu = itu;
      check_itu(otherwise ? *otherwise : root, part, material);
    }
    table.otherwise_.emplace_back(std::string(part), material);
  }
  if (const auto layers = root.table("layers")) {
    for (const std::string_view kind : kLayers) {
      table.layers_.emplace_back(std::string(kind), read_words(*layers, kind));
    }
  }
  RAYLOC_TRY(document.finish());
  return table;
}

std::optional<StatedMaterial> MaterialTable::find(std::string_view material,
                                                  std::string_view object) const {
  for (const std::string& name : {split_words(material), split_words(object)}) {
    for (const Row& row : rows_) {
      if (holds_one(name, row.words)) {
        return row.material;
      }
    }
  }
  return std::nullopt;
}

std::string MaterialTable::layer(std::string_view name) const {
  const auto is_name = [&](const std::string& one) { return lower_case(one) == lower_case(name); };
  if (std::any_of(named_walls_.begin(), named_walls_.end(), is_name)) {
    return "wall";
  }
  const std::string words = split_words(name);
  for (const auto& [kind, of] : layers_) {
    if (holds_one(words, of)) {
      return kind;
    }
  }
  return "";
}

StatedMaterial MaterialTable::otherwise(std::string_view part) const {
  for (const auto& [name, material] : otherwise_) {
    if (name == part) {
      return material;
    }
  }
  return {};
}

}  // namespace rayloc
